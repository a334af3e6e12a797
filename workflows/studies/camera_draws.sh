#!/usr/bin/env bash
# Measures the error of the metric result, and how well its stated sigma predicts this error, over
# random cameras, prints and scenes. Each draw renders a short clip, runs automatic_reconstructor
# with its defaults except for an exact print, and compares the shape with the truth.
# usage: workflows/studies/camera_draws.sh [--quick] [--num_draws N] [--seed S] [WORK_FOLDER]
#        (default: 200 draws, 6 for --quick, seed 1, workspace/studies)
# Writes camera_draws.csv, one row per draw with its conditions, the errors of the corners
# (clip_corners) and the errors of the shape, and camera_draws_summary.csv, one row per class. Rows
# that camera_draws.csv already holds are kept, so that an interrupted study can continue; remove
# the file to measure another version of velamap. Clips are removed after their draw. VELAMAP_JOBS
# (default: one for each processor) draws run at once.
# KEEP="12 31" runs these draws again and keeps their clips and results in runs/camera_draws.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

read_draw_arguments "$@"
begin_study camera_draws "${rest[@]}"
clip_corners="$(find_program CLIP_CORNERS clip_corners tests/tools/clip_corners)"
if [[ -z "$num_draws" ]]; then num_draws=$((quick ? 6 : 200)); fi
csv="$work/camera_draws.csv"

mapfile -t draws < <(awk -f "$studies/random.awk" -f "$studies/draw_cameras.awk" -v seed="$seed" \
  -v num_draws="$num_draws" -v quick="$quick")
IFS=, read -ra names <<<"${draws[0]}"
results=(exit_code side_px side_bias_px side_bias_percent corner_error_px corner_error_over_sigma
  num_detections num_false num_images num_markers scale_error_percent scale_sigma_percent
  error_over_sigma distance_mm_rms distance_after_scaling_mm_rms verdict num_warnings
  found_gamma found_s_curve found_sharpening found_radius_px found_ink_percent found_residual seconds)

# log_value RUN KEY: prints the text after `KEY: ` in a log, up to the first space or comma.
log_value() { awk -v key="$2:" '$1 == key { sub(",.*", "", $2); print $2; exit }' "$runs/$1/log.txt"; }

# formation RUN: prints the six values of the importer's estimate of camera and print.
formation() {
  awk '/camera and print, from/ {
      for (i = 1; i < NF; i++) {
        if ($i == "gamma") gamma = $(i + 1)
        if ($i == "S-curve") s_curve = $(i + 1)
        if ($i == "sharpening") { amount = $(i + 1); radius = $(i + 3) }
        if ($i == "spread") ink = $(i + 1)
        if ($i == "residuals") residual = $(i + 1)
      }
      gsub(",", "", gamma); gsub(",", "", s_curve)
    }
    END { print gamma "," s_curve "," amount "," radius "," ink "," residual }' "$runs/$1/log.txt"
}

# run_draw NAME RENDER_CLIP_OPTION...: renders, reconstructs and analyzes a clip in runs/NAME.
run_draw() {
  local run="$runs/$1" clip="$runs/$1/clip" code=0
  mkdir -p "$run"
  "$render_clip" --camera plain "${@:2}" --num_threads 1 --output_path "$clip" >"$run/render.txt" 2>&1 ||
    fail "render_clip failed: $(tail -n 1 "$run/render.txt")"
  # The print is exact. A tolerance would hide errors of the detected edges.
  "$velamap" automatic_reconstructor --image_path "$clip/clip.mp4" --num_threads 1 \
    --camera_path "$clip/camera.yml" --layout_path "$clip/layout.yml" \
    --workspace_path "$run/workspace" --MarkerAdjustment.common_print_tolerance 0 \
    >"$run/log.txt" 2>&1 || code=$?
  echo "$code" >"$run/exit_code.txt"
  "$clip_corners" --clip_path "$clip" --database_path "$run/workspace/database.db" \
    >"$run/corners.txt" 2>&1 || true  # a clip without detections is a valid outcome
  if [[ -f "$run/workspace/shape/shape.csv" ]]; then
    "$velamap" shape_analyzer --shape_path "$run/workspace/shape" --log_level error \
      --input_path "$run/workspace/sparse/0" --layout_path "$clip/layout.yml" \
      --reference_path "$clip/truth.csv" --csv_path "$run/analysis.csv" >"$run/analysis.txt" 2>&1 ||
      true  # a shape without anything to compare is a valid outcome
  fi
}

# result_row NAME SECONDS: prints the results of a draw as a row.
result_row() {
  local error sigma key
  error="$(metric "$1" scale_error_percent)"
  sigma="$(awk -F, '$1 == "" && $3 == "scale_sigma_percent" { print $4 }' \
    "$runs/$1/workspace/shape/metrics.csv" 2>/dev/null || true)"
  printf '%s' "$(cat "$runs/$1/exit_code.txt"),$(value_in "$runs/$1/render.txt" side_px)"
  for key in side_bias_px side_bias_percent corner_error_px corner_error_over_sigma num_markers \
    num_false; do
    printf ',%s' "$(value_in "$runs/$1/corners.txt" "$key")"
  done
  printf ',%s' "$(log_value "$1" images)" "$(metric "$1" num_markers)" "$error" "$sigma" \
    "$(awk -v e="$error" -v s="$sigma" 'BEGIN { if (e != "" && s > 0) printf "%.3f", e / s }')" \
    "$(metric "$1" distance_mm_rms)" "$(metric "$1" distance_after_scaling_mm_rms)" \
    "$(log_value "$1" verdict)" "$(grep -c 'warning: ' "$runs/$1/log.txt" || true)" \
    "$(formation "$1")" "$2"
  printf '\n'
}

# is_kept DRAW: whether KEEP names a draw.
is_kept() { [[ " ${KEEP:-} " == *" $1 "* ]]; }

# measure_draw DRAW CONDITIONS OPTION...: runs a draw and appends its row.
measure_draw() {
  local start=$SECONDS name="draw_$1"
  run_draw "$name" "${@:3}"
  echo "$2,$(result_row "$name" $((SECONDS - start)))" >>"$csv"
  is_kept "$1" || rm -rf "${runs:?}/$name"
}

header="${draws[0]},$(IFS=,; echo "${results[*]}")"
known="$work/camera_draws.known"
: >"$known"
if [[ -f "$csv" && "$(head -n 1 "$csv")" == "$header" ]]; then cp "$csv" "$known"; fi
echo "$header" >"$csv"
# Each draw has one thread, so that its result does not depend on how many run at once.
num_running=0
for conditions in "${draws[@]:1}"; do
  IFS=, read -ra values <<<"$conditions"
  if ! is_kept "${values[0]}" && grep -F -m 1 -- "$conditions," "$known" >>"$csv"; then continue; fi
  options=()
  for ((i = 3; i < ${#names[@]}; i++)); do
    if [[ -n "${values[i]:-}" ]]; then options+=("--${names[i]}" "${values[i]}"); fi
  done
  if [[ $num_running -eq ${VELAMAP_JOBS:-$(nproc)} ]]; then
    wait -n
    num_running=$((num_running - 1))
  fi
  measure_draw "${values[0]}" "$conditions" "${options[@]}" &
  num_running=$((num_running + 1))
done
for ((i = 0; i < num_running; i++)); do wait -n; done
rm "$known"
{ echo "$header"; sed 1d "$csv" | sort -t, -k1,1n; } >"$csv.sorted"
mv "$csv.sorted" "$csv"
awk -f "$studies/summarize_draws.awk" "$csv" >"$work/camera_draws_summary.csv"
finish "$work/camera_draws_summary.csv"
