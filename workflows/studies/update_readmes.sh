#!/usr/bin/env bash
# Writes the measured numbers into the READMEs. Every such number stands in a block
#   <!-- numbers: NAME -->
#   ...
#   <!-- end -->
# The function block_NAME of a readme_blocks.sh, here or in tests/benchmarks, makes its text from
# the stored results. These are the tables that the studies and benchmarks write. They are in
# workflows/studies/results and tests/benchmarks/results; their first line names the command that
# made them.
# usage: workflows/studies/update_readmes.sh [MODE] [RESULT...] [WORK_FOLDER]
#   (no mode)   runs the commands whose results are not stored, stores them, and writes the READMEs
#   --rerun     the same, but also runs the commands of stored results
#   --collect   stores results that earlier runs left in WORK_FOLDER, and writes the READMEs
#   --write     only writes the READMEs from the stored results
#   --check     changes nothing; prints FILE:LINE of each block that is out of date and exits with 1
# RESULT is the file name of a result, such as accuracy.csv; without it, all results are meant.
# WORK_FOLDER (default: workspace/studies) keeps rendered clips for the next run. VELAMAP,
# RENDER_CLIP and BUILD name other programs.
set -euo pipefail
export LC_ALL=C

folder="$(realpath "$(dirname "${BASH_SOURCE[0]}")")"
repository="$(realpath "$folder/../..")"
# shellcheck source-path=SCRIPTDIR source=readme_tables.sh
source "$folder/readme_tables.sh"
# shellcheck source-path=SCRIPTDIR source=readme_blocks.sh
source "$folder/readme_blocks.sh"
# shellcheck source-path=SCRIPTDIR source=../../tests/benchmarks/readme_blocks.sh
source "$repository/tests/benchmarks/readme_blocks.sh"

fail() {
  echo "error: $*" >&2
  exit 2
}

# The commands that write the results into the work folder.
declare -A command_of
for study in accuracy board_motions found_cameras freeform marker_design parameters repeatability rigid_objects rolling_shutter sample_project shooting surface unknown_cameras; do
  command_of[$study.csv]="workflows/studies/$study.sh"
done
command_of[sample_project.txt]=workflows/studies/sample_project.sh
command_of[camera_draws_summary.csv]="workflows/studies/camera_draws.sh --num_draws 40"
command_of[surface_curvature.csv]=workflows/studies/surface.sh
for table in central_frames central_frames_histogram; do
  command_of[$table.csv]=workflows/studies/central_frames.sh
done
for table in conditions conditions_motion_lines; do
  command_of[$table.csv]=workflows/studies/conditions.sh
done
for part in detection adjustment main memory growth markers tracking sweep dataset; do
  command_of[$part.csv]="tests/benchmarks/compare.sh $part"
done
command_of[corner_accuracy.csv]=tests/benchmarks/corner_accuracy.sh

# The folders of results that cannot be reproduced, because they compare with code that was removed.
declare -A folder_of_past=([own_solver.csv]=tests/benchmarks)

# stored RESULT: prints the path of a stored result, which is beside the command that makes it.
stored() {
  local program="${command_of[$1]:-}"
  program="${program%% *}"
  echo "$repository/${folder_of_past[$1]:-${program%/*}}/results/$1"
}

# settings: prints assignments of the variables that change what a command measures.
settings() {
  local name
  for name in CAMERA CLIPS WAYS NUM_FRAMES SKIPS NEIGHBORHOODS SIGMAS BETAS INLIER_DISTANCES CENTRAL_FRAMES \
    DISTANCES BACKEND START WIDTHS MBIT LONG REPEATS; do
    if [[ -n "${!name:-}" ]]; then printf '%s="%s" ' "$name" "${!name}"; fi
  done
}

# store RESULT: stores a result from the work folder with its command. Numbers get six digits.
store() {
  [[ -f "$work/$1" ]] || fail "${command_of[$1]} has made no $1"
  mkdir -p "$(dirname "$(stored "$1")")"
  {
    echo "# $(settings)${command_of[$1]}"
    if [[ "$1" == *.csv ]]; then
      awk -F, -v OFS=, '{
        for (i = 1; i <= NF; i++) if ($i ~ /^-?[0-9]+\.[0-9]+(e-?[0-9]+)?$/) $i = sprintf("%.6g", $i)
        print
      }' "$work/$1"
    else
      cat "$work/$1"
    fi
  } >"$(stored "$1")"
  echo "== stored: $(stored "$1")"
}

# commands_of RESULT...: prints the commands that make the results, each once.
commands_of() {
  local result
  for result in "$@"; do echo "${command_of[$result]}"; done | sort -u
}

# results_of COMMAND: prints all results that a command makes. They are stored together, because
# they belong to one run.
results_of() {
  local result
  for result in "${!command_of[@]}"; do
    if [[ "${command_of[$result]}" == "$1" ]]; then echo "$result"; fi
  done
}

# measure RESULT...: runs each command of the results once and stores all results that it makes.
measure() {
  local result command commands
  mapfile -t commands < <(commands_of "$@")
  for command in "${commands[@]}"; do
    read -ra words <<<"$command"
    "$repository/${words[0]}" "${words[@]:1}" "$work" || fail "$command failed"
    for result in $(results_of "$command"); do store "$result"; done
  done
}

# collect RESULT...: stores what the work folder has of all results of the same commands.
collect() {
  local result command commands
  mapfile -t commands < <(commands_of "$@")
  for command in "${commands[@]}"; do
    for result in $(results_of "$command"); do
      if [[ -f "$work/$result" ]]; then store "$result"; fi
    done
  done
}

# fill README: prints a README with its blocks filled, and records the blocks that have changed.
fill() {
  local readme="$1" line number=0 name="" start=0 text
  while IFS= read -r line; do
    number=$((number + 1))
    if [[ -n "$name" && "$line" != '<!-- end -->' ]]; then
      printf '%s\n' "$line" >>"$temporary/old"
      continue
    fi
    if [[ -n "$name" ]]; then
      text="$(block "$name" "${readme#"$repository/"}:$start")"
      printf '%s\n' "$text"
      if [[ "$text" != "$(cat "$temporary/old")" ]]; then
        report_difference "${readme#"$repository/"}" "$start" "$name" "$text"
      fi
      name=""
    elif [[ "$line" == '<!-- end -->' ]]; then
      problem "${readme#"$repository/"}:$number: <!-- end --> without a block"
    elif [[ "$line" =~ ^'<!-- numbers: '([a-z_]+)' -->'$ ]]; then
      name="${BASH_REMATCH[1]}" start=$number
      : >"$temporary/old"
    elif [[ "$line" == '<!-- numbers'* ]]; then
      problem "${readme#"$repository/"}:$number: expected a line <!-- numbers: NAME -->"
    fi
    printf '%s\n' "$line"
  done <"$readme"
  if [[ -n "$name" ]]; then problem "${readme#"$repository/"}:$start: block $name has no <!-- end -->"; fi
}

# block NAME PLACE: prints the text of a block. The text is made once and kept for other READMEs.
block() {
  if ! declare -F "block_$1" >/dev/null; then
    problem "$2: no readme_blocks.sh makes the block $1"
    return
  fi
  if [[ ! -f "$temporary/$1.block" ]]; then
    place="$2" "block_$1" >"$temporary/$1.block"
  fi
  cat "$temporary/$1.block"
}

# report_difference README START NAME TEXT: records the first line of a block that differs.
report_difference() {
  local offset
  offset="$({ diff "$temporary/old" <(printf '%s\n' "$4") || true; } | sed -n '1s/[^0-9].*//p')"
  echo "$1:$(($2 + (offset > 0 ? offset : 1))): block $3 is not what the stored results give" \
    >>"$temporary/differences"
}

mode=measure names=() work=workspace/studies
for argument in "$@"; do
  case "$argument" in
    --rerun | --collect | --write | --check) mode="${argument#--}" ;;
    --help)
      sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    -*) fail "$argument: unknown option; see --help" ;;
    *.csv | *.txt)
      [[ -n "${command_of[$argument]:-}" ]] || fail "$argument: no such result; see --help"
      names+=("$argument")
      ;;
    *) work="$argument" ;;
  esac
done

temporary="$(mktemp -d)"
trap 'rm -rf "$temporary"' EXIT
: >"$temporary/differences"
: >"$temporary/problems"
if [[ $mode == check || $mode == write ]]; then
  [[ ${#names[@]} -eq 0 ]] || fail "--$mode goes over all results; name none"
else
  mkdir -p "$work"
  work="$(realpath "$work")"
  if [[ ${#names[@]} -eq 0 ]]; then mapfile -t names < <(printf '%s\n' "${!command_of[@]}" | sort); fi
  if [[ $mode == collect ]]; then
    collect "${names[@]}"
  else
    wanted=()
    for name in "${names[@]}"; do
      if [[ $mode == rerun || ! -f "$(stored "$name")" ]]; then wanted+=("$name"); fi
    done
    if [[ ${#wanted[@]} -gt 0 ]]; then measure "${wanted[@]}"; fi
  fi
fi

while IFS= read -r readme; do
  fill "$readme" >"$temporary/readme"
  if [[ $mode != check && ! -s "$temporary/problems" ]] && ! cmp -s "$temporary/readme" "$readme"; then
    cat "$temporary/readme" >"$readme"
    echo "== written: $readme"
  fi
done < <(find "$repository" -name '*.md' -not -path '*/build/*' -not -path '*/workspace/*' \
  -not -path '*/.*' | sort)

if [[ -s "$temporary/problems" ]]; then
  sed 's/^/error: /' "$temporary/problems" >&2
  exit 1
fi
if [[ $mode == check && -s "$temporary/differences" ]]; then
  cat "$temporary/differences" >&2
  echo "error: numbers in the READMEs are out of date; run workflows/studies/update_readmes.sh --write" >&2
  exit 1
fi
