#!/usr/bin/env bash
# Measures how much accuracy is lost without a calibration. Each draw renders a short clip through a
# random lens and runs automatic_reconstructor with the true calibration and without one.
# usage: workflows/studies/unknown_cameras.sh [--quick] [--num_draws N] [--seed S] [WORK_FOLDER]
#        (default: 9 draws, 4 for --quick, seed 1, workspace/studies)
# Writes unknown_cameras.csv with one row per draw: the error of the focal length and its sigma, and
# the errors of both shapes against the truth.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

read_draw_arguments "$@"
begin_study unknown_cameras "${rest[@]}"
if [[ -z "$num_draws" ]]; then num_draws=$((quick ? 4 : 9)); fi
num_frames=$((quick ? 16 : 20))

# write_lens FILE LENS WIDTH FOCAL CX CY D1 D2 D3 D4: writes a calibration file.
write_lens() {
  {
    printf '%%YAML:1.0\n---\nimage_width: %d\nimage_height: %d\n' "$3" $(($3 * 9 / 16))
    printf 'camera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n'
    printf '  data: [%s, 0., %s, 0., %s, %s, 0., 0., 1.]\n' "$4" "$5" "$4" "$6"
    printf 'distortion_coefficients: !!opencv-matrix\n  rows: 1\n  cols: 4\n  dt: d\n'
    printf '  data: [%s, %s, %s, %s]\n' "$7" "$8" "$9" "${10}"
    if [[ "$2" == fisheye ]]; then echo 'distortion_model: fisheye'; fi
  } >"$1"
}

# run_job RUN CLIP OPTION...: reconstructs a clip in runs/RUN and compares the shape with the truth.
run_job() {
  local run="$runs/$1" clip="$2"
  mkdir -p "$run"
  "$velamap" automatic_reconstructor --image_path "$clip/clip.mp4" --layout_path "$clip/layout.yml" \
    --workspace_path "$run/workspace" "${@:3}" >"$run/log.txt" 2>&1 || return 0
  "$velamap" shape_analyzer --shape_path "$run/workspace/shape" --log_level error \
    --input_path "$run/workspace/sparse/0" --layout_path "$clip/layout.yml" \
    --reference_path "$clip/truth.csv" --csv_path "$run/analysis.csv" >"$run/analysis.txt" 2>&1 || true
}

csv="$work/unknown_cameras.csv"
mapfile -t draws < <(awk -f "$studies/random.awk" -f "$studies/draw_lenses.awk" -v seed="$seed" \
  -v num_draws="$num_draws" -v quick="$quick")
echo "draw,lens,scene,focal_widths,model,focal_px,focal_sigma_px,focal_error_percent,\
distance_after_scaling_mm,distance_after_scaling_calibrated_mm,ratio,scale_error_percent,\
scale_error_calibrated_percent" >"$csv"
for draw in "${draws[@]:1}"; do
  IFS=, read -r number lens scene width widths focal cx cy d1 d2 d3 d4 options <<<"$draw"
  name="draw_$number"
  mkdir -p "$runs/$name"
  write_lens "$runs/$name/lens.yml" "$lens" "$width" "$focal" "$cx" "$cy" "$d1" "$d2" "$d3" "$d4"
  read -ra more <<<"$options"
  make_clip "unknown_camera_$number" --scene "$scene" --width "$width" --lens \
    "$runs/$name/lens.yml" --camera action --num_frames "$num_frames" --fps 3 "${more[@]}"
  clip="$clips/unknown_camera_$number"
  run_job "$name/calibrated" "$clip" --camera_path "$clip/camera.yml"
  run_job "$name/unknown" "$clip"
  error="$(metric "$name/unknown" distance_after_scaling_mm_rms)"
  calibrated="$(metric "$name/calibrated" distance_after_scaling_mm_rms)"
  found="$(found_focal "$name/unknown")"
  echo "$number,$lens,$scene,$widths,$found,$(awk -F, -v focal="$focal" \
    '{ if ($2 != "") printf "%.3f", 100 * ($2 / focal - 1) }' <<<"$found"),$error,$calibrated,$(
    awk -v e="$error" -v c="$calibrated" 'BEGIN { if (e != "" && c > 0) printf "%.2f", e / c }'),$(
    metric "$name/unknown" scale_error_percent),$(metric "$name/calibrated" scale_error_percent)" \
    >>"$csv"
done
finish "$csv"
