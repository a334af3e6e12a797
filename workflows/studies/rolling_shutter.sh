#!/usr/bin/env bash
# Measures the error of the shape due to a rolling shutter, without and with its correction. The
# clips have a random time from the first row to the last (zero in every third clip), shake and
# flapping.
# usage: workflows/studies/rolling_shutter.sh [--quick] [WORK_FOLDER]
#        (default: 12 clips, 2 for --quick, workspace/studies)
# Writes rolling_shutter.csv with one row per clip: its conditions, the estimated time and its
# sigma, and the RMS distance from the truth after a similarity transformation, without and with the
# correction.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study rolling_shutter "$@"
csv="$work/rolling_shutter.csv"
echo "clip,scene,shutter_ms,shake_deg,sail_motion_m,found_ms,sigma_ms,distance_without_mm,distance_mm" \
  >"$csv"

draw_clips() {  # NUM_CLIPS
  awk -v num_clips="$1" -v state=20201 "$(cat "$studies/random.awk")"'
    BEGIN {
      for (i = 1; i <= num_clips; i++) {
        shutter = i % 3 == 0 ? 0 : (uniform() < 0.25 ? -1 : 1) * (4 + 26 * uniform())
        shake = 0.6 * uniform()
        scene = i % 2 == 1 ? "sail" : "walls"
        motion = scene == "sail" ? 0.02 * uniform() : 0
        printf "%d %s %.2f %.2f %.3f %d\n", i, scene, shutter, shake, motion, 1 + int(1e6 * uniform())
      }
    }'
}

# adjust CLIP RUN 0|1: adjusts without (0) or with (1) an estimate of the rolling shutter. Prints
# the RMS distance after a similarity, and writes the summary to RUN/adjust.txt.
adjust() {
  local clip="$clips/$1" run="$runs/$2"
  mkdir -p "$run"
  "$velamap" bundle_adjuster --input_path "$runs/$1.seed" --output_path "$run/model" \
    --database_path "$clip/database.db" --layout_path "$clip/layout.yml" --backend both \
    --MarkerAdjustment.estimate_rolling_shutter "$3" --log_level error >"$run/adjust.txt"
  "$velamap" shape_exporter --input_path "$run/model" --output_path "$run/metric" \
    --shape_path "$run/shape" --layout_path "$clip/layout.yml" --log_level error >"$run/shape.txt"
  "$velamap" shape_analyzer --shape_path "$run/shape" --input_path "$run/metric" \
    --layout_path "$clip/layout.yml" --reference_path "$clip/truth.csv" --log_level error |
    awk '$1 == "distance_after_scaling_mm_rms:" { print $2 }'
}

while read -r i scene shutter_ms shake_deg motion_m seed; do
  name="shutter_$i"
  size=()
  if [[ $quick -eq 1 ]]; then size=(--width 1280 --sail_scale 0.5 --distance 3); fi
  make_clip "$name" --scene "$scene" --num_frames 150 "${size[@]}" --shake_deg "$shake_deg" \
    --sail_motion_m "$motion_m" --seed "$seed" --camera action \
    --rolling_shutter_s "$(awk -v ms="$shutter_ms" 'BEGIN { print ms / 1000 }')"
  "$velamap" frame_registrator --database_path "$clips/$name/database.db" \
    --layout_path "$clips/$name/layout.yml" --output_path "$runs/$name.seed" --log_level error \
    >"$runs/$name.txt"
  without_mm="$(adjust "$name" "$name.without" 0)"
  with_mm="$(adjust "$name" "$name.with" 1)"
  found="$(awk '$1 == "rolling_shutter_ms:" { print $2 "," $4 }' "$runs/$name.with/adjust.txt")"
  echo "$i,$scene,$shutter_ms,$shake_deg,$motion_m,${found:-,},$without_mm,$with_mm" >>"$csv"
done < <(draw_clips $((quick ? 2 : 12)))
finish "$csv"
