#!/usr/bin/env bash
# Measures the assumptions of shoot_planner, and compares its plans with clips of an action camera
# that are rendered according to them.
# usage: workflows/studies/shooting.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# Writes shooting.csv. The series `distance` has the share of the markers found and the errors of
# their corners by distance; `motion` has the same by the motion of a marker while the shutter is
# open; `plan` has the planned and the resulting sigmas and the true errors of clips that move 100
# degrees around a sail.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study shooting "$@"
clip_corners="$(find_program CLIP_CORNERS clip_corners tests/tools/clip_corners)"
action=(--camera action --tone_curve srgb --sail_scale 0.7 --crf 21)
if [[ $quick -eq 1 ]]; then
  distances=(5) motions=(2) plans=(4) num_plan_frames=24
else
  distances=(4 5 6 7 8 9) motions=(0 1 2 3 4 5 6) plans=(3 4 5 6) num_plan_frames=80
fi

csv="$work/shooting.csv"
echo "series,width_px,distance_m,motion_px,side_px,found_percent,corner_error_px,planned_distance_sigma_mm,distance_sigma_mm,distance_mm,planned_shape_sigma_mm,shape_sigma_mm,shape_mm,planned_marker_sigma_mm,marker_sigma_mm" >"$csv"

# seen SERIES WIDTH DISTANCE MOTION: writes a row for ten frontal views that show every marker.
seen() {
  local name="shooting_$1_$2_$3_$4" frames=10
  make_clip "$name" "${action[@]}" --width "$2" --distance "$3" --motion_blur_px "$4" \
    --num_frames $frames --fps 2 --drift_deg 10
  if ! "$clip_corners" --clip_path "$clips/$name" --database_path "$clips/$name/database.db" \
    >"$runs/$name.txt" 2>/dev/null; then return; fi
  awk -v OFS=, -v series="$1" -v width="$2" -v distance="$3" -v motion="$4" \
    -v side="$(value_in "$runs/$name.txt" side_px)" \
    -v found="$(value_in "$runs/$name.txt" num_markers)" \
    -v error="$(value_in "$runs/$name.txt" corner_error_px)" \
    -v possible="$((frames * $(num_true_markers "$name")))" \
    'BEGIN { print series, width, distance, motion, side, 100 * found / possible, error, "", "", "", "", "", "", "", "" }' \
    >>"$csv"
}
for distance in "${distances[@]}"; do seen distance 1920 "$distance" 0; done
for motion in "${motions[@]}"; do seen motion 1920 4 "$motion"; done
if [[ $quick -eq 0 ]]; then
  for motion in 0 3 6 9; do seen motion 3840 4 "$motion"; done
fi

# median_sigma_mm SHAPE_CSV: prints the median 3D sigma of the marker centres.
median_sigma_mm() {
  awk -F, '$2 == 0 { print 1000 * sqrt($6 ^ 2 + $7 ^ 2 + $8 ^ 2) }' "$1" | sort -g |
    awk '{ sigma[NR] = $1 } END { print sigma[int((NR + 1) / 2)] }'
}

# planned DISTANCE: compares a plan with its clip and writes the row.
planned() {
  local name="shooting_plan_$1" clip
  clip="$clips/$name"
  make_clip "$name" "${action[@]}" --distance "$1" --drift_deg 50 --num_frames "$num_plan_frames" \
    --fps 15 --motion_blur_px 1
  "$velamap" shoot_planner --camera_path "$clip/camera.yml" --layout_path "$clip/layout.yml" \
    --shape_path "$clip/truth.csv" --Plan.distance "$1" --Plan.arc 100 \
    --Plan.num_views "$num_plan_frames" --log_level error >"$runs/$name.plan.txt"
  "$velamap" automatic_reconstructor --image_path "$clip/clip.mp4" --camera_path "$clip/camera.yml" \
    --layout_path "$clip/layout.yml" --workspace_path "$runs/$name" --log_level error \
    >"$runs/$name.txt" 2>"$runs/$name.log" || fail "$runs/$name.log says what went wrong"
  "$velamap" shape_analyzer --shape_path "$runs/$name/shape" --input_path "$runs/$name/sparse/0" \
    --layout_path "$clip/layout.yml" --reference_path "$clip/truth.csv" --log_level error \
    >"$runs/$name.result.txt"
  local plan="$runs/$name.plan.txt" result="$runs/$name.result.txt"
  printf 'plan,1920,%s,1,%s,%s,,%s,%s,%s,%s,%s,%s,%s,%s\n' "$1" "$(value_in "$plan" side_px)" \
    "$(value_in "$plan" found_percent)" "$(value_in "$plan" distance_sigma_mm)" \
    "$(value_in "$result" distance_sigma_mm)" "$(value_in "$result" distance_mm_rms)" \
    "$(value_in "$plan" distance_after_scaling_sigma_mm)" \
    "$(value_in "$result" distance_after_scaling_sigma_mm)" \
    "$(value_in "$result" distance_after_scaling_mm_rms)" "$(value_in "$plan" marker_sigma_mm)" \
    "$(median_sigma_mm "$runs/$name/shape/shape.csv")" >>"$csv"
}
for distance in "${plans[@]}"; do planned "$distance"; done
finish "$csv"
