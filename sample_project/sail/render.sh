#!/usr/bin/env bash
# Renders the clip of this folder again: a boat that moves 100 degrees around a sail of 5.1 x 2.6 m at
# 4.5 m, with an action camera. Needs render_clip (workflows/build.sh release render_clip).
# usage: sample_project/sail/render.sh [FOLDER]   (default: this folder; RENDER_CLIP: the program)
set -euo pipefail

here="$(realpath "$(dirname "${BASH_SOURCE[0]}")")"
folder="${1:-$here}"
"${RENDER_CLIP:-$here/../../build/release/tests/tools/render_clip}" --output_path "$folder" \
  --camera action --tone_curve srgb --scene sail --sail_scale 0.85 --distance 4.5 --drift_deg 50 \
  --num_frames 150 --fps 30 --motion_blur_px 1 --rolling_shutter_s 0.012 --shake_deg 0.3 \
  --preset medium --crf 21
rm "$folder/poses.csv" "$folder/scene.ini"
