# shellcheck shell=bash
# Functions that the studies share. They parse options, find the programs, render and import clips,
# reconstruct a clip for given parameters, and read the metrics. The studies source this file.
#
# A work folder holds
#   clips/NAME    a rendered clip with its truth, its detections (database.db) and arguments.txt
#   runs/STUDY    every reconstruction of a study: models, shape, analysis.csv, log.txt
#   STUDY*.csv, STUDY*.png   the tables and plots
# Clips are reused, also by other studies, as long as their arguments are the same. They are
# imported again if velamap is newer than their detections.
set -euo pipefail
export LC_ALL=C

fail() {
  echo "error: $*" >&2
  exit 2
}

# The folders of the studies and of the repository.
studies="$(dirname "${BASH_SOURCE[0]}")"
# shellcheck disable=SC2034  # some studies use it
repository="$(realpath "$studies/../..")"
# shellcheck source-path=SCRIPTDIR source=../find_program.sh
source "$studies/../find_program.sh"

# begin_study NAME "$@": parses the common arguments [--quick] [WORK_FOLDER]; sets study, quick,
# work, clips, runs, sail, velamap and render_clip; and empties the folder of the study's runs.
begin_study() {
  study="$1"
  shift
  quick=0
  work=workspace/studies
  while [[ $# -gt 0 ]]; do
    case "$1" in
      --quick) quick=1 ;;
      --help)
        sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
        exit 0
        ;;
      -*) fail "$1: unknown option; expected [--quick] [WORK_FOLDER]" ;;
      *) work="$1" ;;
    esac
    shift
  done
  velamap="$(find_program VELAMAP velamap workflows/velamap)"
  render_clip="$(find_program RENDER_CLIP render_clip tests/tools/render_clip)"
  mkdir -p "$work"
  work="$(realpath "$work")"
  clips="$work/clips"
  runs="$work/runs/$study"
  rm -rf "$runs"
  mkdir -p "$clips" "$runs"
  if [[ $quick -eq 1 ]]; then sail=("${quick_sail[@]}"); else sail=("${full_sail[@]}"); fi
  echo "== $study: into $work"
}

# read_draw_arguments "$@": parses the arguments of a study of random clips. Sets num_draws (empty
# if not given) and seed, and leaves the other arguments in rest.
read_draw_arguments() {
  num_draws="" seed=1 rest=()
  while [[ $# -gt 0 ]]; do
    case "$1" in
      --num_draws | --seed)
        [[ "${2:-}" =~ ^[0-9]{1,6}$ && "$2" -gt 0 ]] || fail "$1: expected a number from 1 on"
        if [[ "$1" == --seed ]]; then seed="$2"; else num_draws="$2"; fi
        shift
        ;;
      *) rest+=("$1") ;;
    esac
    shift
  done
}

# The options of render_clip for the sail of the studies, which has 122 markers of 100 mm as in
# section 4.3 of the thesis. With --quick, the sail has half the size.
full_sail=(--scene sail --width 1920)
quick_sail=(--scene sail --width 1280 --sail_scale 0.5 --distance 3)

# The numbers of frames of the sail's clips. The longest search must fit into the near clip.
short_clip_frames() { if [[ $quick -eq 1 ]]; then echo 90; else echo 220; fi; }
near_clip_frames() { if [[ $quick -eq 1 ]]; then echo 110; else echo 600; fi; }

# is_current FILE: whether the file exists and is not older than velamap.
is_current() { [[ -f "$1" && ! "$velamap" -nt "$1" ]]; }

# make_clip NAME RENDER_CLIP_ARGUMENT...: renders and imports clips/NAME unless it is up to date.
make_clip() {
  local folder="$clips/$1" arguments="${*:2}"
  if [[ ! -f "$folder/arguments.txt" || "$(cat "$folder/arguments.txt")" != "$arguments" ]]; then
    rm -rf "$folder"
    echo "== $study: clip $1: $arguments"
    "$render_clip" "${@:2}" --output_path "$folder" >"$work/render.log" 2>&1 ||
      fail "render_clip failed: $(tail -n 1 "$work/render.log")"
    rm "$work/render.log"
    echo "$arguments" >"$folder/arguments.txt"
  fi
  if is_current "$folder/import.txt"; then return; fi
  rm -f "$folder/database.db"
  if ! "$velamap" marker_importer --image_path "$folder/clip.mp4" \
    --camera_path "$folder/camera.yml" --layout_path "$folder/layout.yml" \
    --database_path "$folder/database.db" --log_level error >"$folder/import.part"; then
    # A clip without detections is a valid outcome of a study.
    echo "== $study: clip $1 gives no detections" >&2
  fi
  mv "$folder/import.part" "$folder/import.txt"
}

# make_sail NAME FOLDER [RENDER_CLIP_OPTION...]: makes a clip of the sail in clips/FOLDER.
make_sail() {
  local options=("${@:3}" --scene sail)
  case "$1" in
    sail_1080p) make_clip "$2" "${options[@]}" --width 1920 --num_frames 400 ;;
    sail_4k) make_clip "$2" "${options[@]}" --width 3840 --num_frames 400 --bitrate 60M ;;
    sail_quick) make_clip "$2" "${options[@]}" --width 1280 --distance 3 --num_frames 60 ;;
    *) fail "$1: no such clip of the sail; expected sail_1080p, sail_4k or sail_quick" ;;
  esac
}

make_near_clip() { make_clip near "${sail[@]}" --num_frames "$(near_clip_frames)"; }

# reconstruct CLIP RUN FRAME_REGISTRATOR_OPTION...: reconstructs a clip in runs/STUDY/RUN. These
# variables change the defaults:
#   TRUTH          the reference (default: the clip's truth.csv)
#   DATABASE       the detections (default: the clip's database.db)
#   METHOD         the registration method (default: thesis)
#   BACKEND        the backend of bundle_adjuster (default: colmap)
#   EXACT_PRINT=1  no print tolerance, because rendered markers are as large as the layout says
#   ADJUST=0       no adjustment
# If the data give no result, the log has the reason and there is no analysis.csv. That is a valid
# outcome of a study.
reconstruct() {
  local clip="$clips/$1" run="$runs/$2"
  mkdir -p "$run"
  if ! reconstruct_steps "$clip" "$run" "${@:3}" >"$run/log.txt" 2>&1; then
    rm -f "$run/analysis.csv"
    echo "== $study: $2: no result: $(grep '^error: ' "$run/log.txt" | tail -n 1)" >&2
    grep -q '^error: ' "$run/log.txt" || fail "$run/log.txt says what went wrong"
  fi
}

# The commands are joined by && because bash ignores `set -e` in the condition of an `if`.
reconstruct_steps() {
  local clip="$1" run="$2" model="$2/adjusted" reference="${TRUTH:-$1/truth.csv}"
  local layout=(--layout_path "$clip/layout.yml" --log_level warn)
  local database=(--database_path "${DATABASE:-$clip/database.db}")
  local adjustment=(--log_level warn)
  if [[ -n "${BACKEND:-}" ]]; then
    adjustment=(--backend "$BACKEND" --log_level warn)
    if [[ "$BACKEND" != colmap ]]; then
      adjustment+=(--layout_path "$clip/layout.yml" "${database[@]}")
    fi
    if [[ "$BACKEND" != colmap && "${EXACT_PRINT:-0}" -eq 1 ]]; then
      adjustment+=(--MarkerAdjustment.common_print_tolerance 0)
    fi
  fi
  if [[ "${ADJUST:-1}" -eq 0 ]]; then model="$run/seed"; fi
  "$velamap" frame_registrator "${database[@]}" --output_path "$run/seed" "${layout[@]}" \
    --Registration.method "${METHOD:-thesis}" "${@:3}" &&
    { [[ "$model" == "$run/seed" ]] || "$velamap" bundle_adjuster --input_path "$run/seed" \
      --output_path "$run/adjusted" "${adjustment[@]}"; } &&
    "$velamap" shape_exporter --input_path "$model" --output_path "$run/metric" \
      --shape_path "$run/shape" "${layout[@]}" &&
    "$velamap" shape_analyzer --shape_path "$run/shape" --input_path "$run/metric" \
      --reference_path "$reference" --part_planes 1 --csv_path "$run/analysis.csv" "${layout[@]}"
}

# search N S M [CENTRAL_FRAME]: prints the options of frame_registrator for these parameters.
search() {
  printf '%s\n' --Registration.num_frames "$1" --Registration.skip "$2" \
    --Registration.neighborhood "$3"
  if [[ $# -gt 3 ]]; then printf '%s\n' --Registration.central_frame "$4"; fi
}

# metric RUN KEY: prints a metric of a reconstruction, or nothing if there is none.
metric() {
  local file="$runs/$1/analysis.csv"
  [[ -f "$file" ]] || return 0
  awk -F, -v key="$2" '$1 == "" && $3 == key { print $4 }' "$file"
}

# found_focal RUN: prints the camera that automatic_reconstructor has found: model, focal length and
# sigma with commas in between; only the commas if none was found. Its output is in log.txt.
found_focal() {
  awk '/^camera: found from the images, / { sub(",", "", $6); print $6 "," $9 "," $11; found = 1 }
    END { if (!found) print ",," }' "$runs/$1/log.txt"
}

# table_metric RUN TABLE NAME_KEY NAME KEY: prints KEY of the row whose NAME_KEY is NAME.
table_metric() {
  local file="$runs/$1/analysis.csv"
  [[ -f "$file" ]] || return 0
  awk -F, -v table="$2" -v name_key="$3" -v name="$4" -v key="$5" '
    $1 != table { next }
    $3 == name_key && $4 == name { row = $2 }
    $3 == key && row != "" && $2 == row { print $4 }' "$file"
}

# value_in FILE KEY: prints the number after `KEY: ` in what a program has printed.
value_in() { sed -n "s/^$2: \([^ ]*\).*/\1/p" "$1"; }

# num_true_markers CLIP: prints the number of markers of a rendered clip.
num_true_markers() { sed 1d "$clips/$1/truth.csv" | cut -d, -f1 | sort -u | wc -l; }

# mean: prints the mean of the numbers on stdin, or nothing if there are none.
mean() { awk '{ sum += $1; n++ } END { if (n) printf "%.6g", sum / n }'; }

# mean_metric KEY RUN...: prints the mean over the reconstructions that have the metric (section
# 4.3.3 of the thesis).
mean_metric() {
  local key="$1" run
  for run in "${@:2}"; do metric "$run" "$key"; done | mean
}

# The metrics in a row about the sail, and the header of such a table.
sail_keys=(image_marker_ratio_count num_markers reconstruction_ratio
  area_error_mm2_mean area_error_mm2_std area_error_mm2_median area_error_mm2_min
  area_error_mm2_max area_error_percent_mean
  central_reprojection_error_px_mean central_reprojection_error_px_std
  central_reprojection_error_px_median central_reprojection_error_px_min
  central_reprojection_error_px_max reprojection_error_px_mean
  scale_error_percent distance_mm_rms distance_after_scaling_mm_rms)
sail_header() {
  local IFS=,
  local keys="${sail_keys[*]}"
  echo "${keys/image_marker_ratio_count/num_images}"
}

# sail_row RUN...: prints the mean of each metric over the reconstructions, each after a comma.
sail_row() {
  local key
  for key in "${sail_keys[@]}"; do printf ',%s' "$(mean_metric "$key" "$@")"; done
  printf '\n'
}

# plot PICTURE [SIZE]: runs the gnuplot script on stdin and writes a PNG into the work folder.
# Without gnuplot it only prints a note.
plot() {
  local size="${2:-900,600}"
  if ! command -v gnuplot >/dev/null; then
    cat >/dev/null
    echo "== $study: no $1: gnuplot is not installed (Debian package gnuplot-nox)" >&2
    return
  fi
  {
    echo "set terminal pngcairo size $size"
    echo "set output '$work/$1'"
    echo "set datafile separator comma; set grid; set key outside bottom center horizontal"
    cat
  } | gnuplot
  echo "$work/$1"
}

# finish CSV...: prints the tables of the study.
finish() {
  local csv
  for csv in "$@"; do
    echo "$csv"
    column -s, -t "$csv" 2>/dev/null || cat "$csv"
  done
}
