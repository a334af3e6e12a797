#!/usr/bin/env bash
# Writes the measured numbers into the READMEs. Every such number stands in a block
#   <!-- numbers: NAME -->
#   ...
#   <!-- end -->
# whose text the function block_NAME of a readme_blocks.sh, here or in tests/benchmarks, makes from the
# stored results: the tables that the studies and benchmarks write, kept in workflows/studies/results
# and tests/benchmarks/results with the command that made them in their first line.
# usage: workflows/studies/update_readmes.sh [MODE] [RESULT...] [WORK_FOLDER]
#   (no mode)   runs the commands whose results are not stored, stores these, writes the READMEs
#   --rerun     runs the commands of the named results (all, if none is named), stored or not
#   --collect   stores results that earlier runs left in WORK_FOLDER, and runs nothing
#   --write     writes the READMEs from what is stored
#   --check     changes nothing; exit 1 and FILE:LINE for every block that is not up to date
# RESULT is a file's name, such as accuracy.csv. WORK_FOLDER is workspace/studies unless given; it
# keeps rendered clips for the next run. VELAMAP, RENDER_CLIP and BUILD name other programs.
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

# The command that writes each result into the work folder.
declare -A command_of
for study in accuracy board_motions marker_design parameters repeatability rigid_objects rolling_shutter sample_project shooting surface; do
  command_of[$study.csv]="workflows/studies/$study.sh"
done
command_of[sample_project.txt]=workflows/studies/sample_project.sh
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

# Folders of results that cannot be made again, because they compare with code that was removed.
declare -A folder_of_past=([own_solver.csv]=tests/benchmarks)

# stored RESULT: where it is kept, beside the command that makes it.
stored() {
  echo "$repository/${folder_of_past[$1]:-$(dirname "${command_of[$1]%% *}")}/results/$1"
}

# settings: the variables that change what a command measures, as they would stand before it.
settings() {
  local name
  for name in CLIPS WAYS NUM_FRAMES SKIPS NEIGHBORHOODS SIGMAS BETAS INLIER_DISTANCES CENTRAL_FRAMES \
    DISTANCES BACKEND START WIDTHS MBIT LONG REPEATS; do
    if [[ -n "${!name:-}" ]]; then printf '%s="%s" ' "$name" "${!name}"; fi
  done
}

# store RESULT: copies it from the work folder with its command, numbers to six digits.
store() {
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

# measure RESULT...: runs each command once, then stores what the results are made of.
measure() {
  local result command commands=()
  mapfile -t commands < <(for result in "$@"; do echo "${command_of[$result]}"; done | sort -u)
  for command in "${commands[@]}"; do
    read -ra words <<<"$command"
    "$repository/${words[0]}" "${words[@]:1}" "$work" || fail "$command failed"
    for result in "${!command_of[@]}"; do
      if [[ "${command_of[$result]}" == "$command" ]]; then store "$result"; fi
    done
  done
}

# fill README: prints it with its blocks filled, and notes where that differs from what stands there.
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

# block NAME PLACE: prints the text of a block, which is made once however many READMEs hold it.
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

# report_difference README START NAME TEXT: names the first line of the block that differs.
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
  wanted=()
  for name in "${names[@]}"; do
    case $mode in
      rerun) wanted+=("$name") ;;
      collect) if [[ -f "$work/$name" ]]; then store "$name"; fi ;;
      measure) if [[ ! -f "$(stored "$name")" ]]; then wanted+=("$name"); fi ;;
    esac
  done
  if [[ ${#wanted[@]} -gt 0 ]]; then measure "${wanted[@]}"; fi
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
