#!/usr/bin/env bash
# Reconstructs several inputs (folders of images, or videos) with one camera and layout, each into its
# own workspace, and writes a row for each into OUTPUT/summary.csv. An earlier summary is
# kept as summary.1.csv, summary.2.csv ...
#
# usage: workflows/run_batch.sh --output_path FOLDER [--keep_going] INPUT... [-- VELAMAP_OPTION...]
#
# For a handful of clips with the same options; needs only jq. workflows/dataset/run.sh (Snakemake) is
# for a data set: clips with their own tags and options in parallel jobs, each computed once, and a page
# of all results.
#
# Options after -- go to every call of `velamap automatic_reconstructor`:
#   workflows/run_batch.sh --output_path results sail1.mp4 sail2.mp4 -- \
#     --camera_path camera.yml --layout_path layout.yml
#
# Stops at the first failure unless --keep_going; the exit code is that of the first failure.
# VELAMAP: the program; the default is that of build/release, else that on the PATH.
set -euo pipefail

# Removes commands to the terminal, which file names may hold.
say() { printf '%s\n' "${*//[[:cntrl:]]/?}"; }
fail() {
  say "error: $*" >&2
  exit 2
}
# shellcheck source-path=SCRIPTDIR source=find_program.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/find_program.sh"

output_path=""
keep_going=0
inputs=()
while [[ $# -gt 0 && "$1" != -- ]]; do
  case "$1" in
    --output_path) output_path="${2:-}"; shift 2 || fail "--output_path needs a folder" ;;
    --output_path=*) output_path="${1#*=}"; shift ;;
    --keep_going) keep_going=1; shift ;;
    --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --*) fail "$1: unknown option; options of velamap go after --" ;;
    *) inputs+=("$1"); shift ;;
  esac
done
[[ $# -gt 0 ]] && shift
[[ -n "$output_path" ]] || fail "--output_path is missing"
[[ ${#inputs[@]} -gt 0 ]] || fail "no input given"
for option in "$@"; do
  case "$option" in
    --summary | --summary=* | --help | --help_all | -h) fail "$option: not for a batch; leave it out" ;;
    --image_path | --image_path=* | --workspace_path | --workspace_path=*)
      fail "$option: a batch gives it itself for each input; leave it out" ;;
  esac
done

command -v jq >/dev/null || fail "jq is not installed; run: apt-get install jq"
velamap="$(find_program VELAMAP velamap workflows/velamap)"

# sail.mp4 and sail/ both become the workspace sail, so two inputs of one name would collide.
workspace_name() {
  local name
  name="$(basename "$(realpath -ms "$1")")"
  if [[ -d "$1" ]]; then echo "$name"; else echo "${name%.*}"; fi
}
duplicates="$(for input in "${inputs[@]}"; do workspace_name "$input"; done | sort | uniq -d)"
[[ -z "$duplicates" ]] || fail "several inputs would go into the workspace $duplicates; rename one"

keys=(verdict num_images_used num_images num_markers num_layout_markers reconstruction_ratio
  reprojection_error_px_mean reprojection_error_px_std area_error_percent_mean area_error_percent_std
  side_error_mm_mean side_error_mm_std scale_sigma_percent length_m width_m depth_m
  num_outliers_removed)

csv_field() { printf '"%s"' "${1//\"/\"\"}"; }

# The text without the folders of absolute paths, because the summary is passed on to others, as velamap's
# logs are.
without_folders() {
  local text="$1" folder
  for folder in "$(dirname "$(realpath -ms "$2")")" "$(realpath -ms "$output_path")"; do
    [[ "$folder" == / ]] || text="${text//"$folder"\//}"
  done
  sed -E "s#(^|[[:space:]'\"(=:,;])/[^/[:space:]][^[:space:]'\"),;]*/#\1#g" <<<"$text"
}

mkdir -p "$output_path" 2>/dev/null || fail "$output_path: cannot be made; give another folder"
summary="$output_path/summary.csv"
# An earlier summary stays, under the next free number.
if [[ -e "$summary" || -L "$summary" ]]; then
  number=1
  while [[ -e "$output_path/summary.$number.csv" || -L "$output_path/summary.$number.csv" ]]; do
    number=$((number + 1))
  done
  mv --no-clobber "$summary" "$output_path/summary.$number.csv"
  say "== the earlier summary is now $output_path/summary.$number.csv"
fi
{ printf 'input,workspace,exit_code,error'; printf ',%s' "${keys[@]}"; printf '\n'; } >"$summary"
results="$(mktemp)"
errors="$(mktemp)"
trap 'rm -f "$results" "$errors"' EXIT

first_failure=0
for input in "${inputs[@]}"; do
  workspace="$output_path/$(workspace_name "$input")"
  say "== $input -> $workspace"
  status=0
  "$velamap" automatic_reconstructor --image_path "$input" --workspace_path "$workspace" --summary json \
    "$@" 2>&1 >"$results" | tee "$errors" >&2 || status="${PIPESTATUS[0]}"
  {
    csv_field "$(basename "$input")"; printf ','
    csv_field "$(basename "$workspace")"; printf ',%d,' "$status"
    csv_field "$(without_folders "$(sed -n 's/^error: //p' "$errors" | tail -n 1)" "$input")"
    if [[ -s "$results" ]]; then
      printf ','
      jq --raw-output --args '[.[$ARGS.positional[]]] | @csv' "${keys[@]}" <"$results"
    else
      printf ",%.0s" "${keys[@]}"
      printf '\n'
    fi
  } >>"$summary"
  [[ ! -s "$results" ]] || echo "== verdict: $(jq --raw-output .verdict "$results")"
  if [[ $status -ne 0 ]]; then
    [[ $first_failure -ne 0 ]] || first_failure=$status
    [[ $keep_going -eq 1 ]] || break
  fi
done
say "== summary: $summary"
exit "$first_failure"
