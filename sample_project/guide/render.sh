#!/usr/bin/env bash
# Renders the pictures of the guides: a good clip and what spoils one, each as a piece of a frame in
# twice its size, and prints what clip_checker says of each clip; and the planner's drawing.
# usage: sample_project/guide/render.sh [FOLDER]   (default: this folder)
# VELAMAP, RENDER_CLIP: the programs; default those of build/release. Needs ffmpeg and rsvg-convert
# (Debian packages ffmpeg and librsvg2-bin).
set -euo pipefail

here="$(realpath "$(dirname "${BASH_SOURCE[0]}")")"
folder="$(realpath "${1:-$here}")"
build="$here/../../build/release"
velamap="${VELAMAP:-$build/workflows/velamap}"
render_clip="${RENDER_CLIP:-$build/tests/tools/render_clip}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# clip NAME DISTANCE DRIFT CRF MOTION [RENDER_CLIP_ARGUMENT...]: a sail of 2.6 x 5.1 m at 1440p.
clip() {
  "$render_clip" --output_path "$work/$1" --camera action --tone_curve srgb --sail_scale 0.85 \
    --width 2560 --num_frames 40 --fps 8 --preset medium --distance "$2" --drift_deg "$3" --crf "$4" \
    --motion_blur_px "$5" "${@:6}" >/dev/null
  ffmpeg -y -loglevel error -ss 2.5 -i "$work/$1/clip.mp4" -frames:v 1 \
    -vf "crop=240:160:1160:640,scale=480:320:flags=neighbor" -q:v 4 "$folder/$1.jpg"
  echo "== $1"
  "$velamap" clip_checker --image_path "$work/$1/clip.mp4" --layout_path "$work/$1/layout.yml" \
    --camera_path "$work/$1/camera.yml" --log_level error |
    grep -E '^(verdict|verdict_reason|markers_seen|side_px|blur_px|grey_levels|precision|parallax_deg):'
}
clip good 4.5 45 21 1
clip far 11 45 21 1
clip motion 4.5 45 21 6
clip glare 4.5 45 21 1 --reflection 4 --glare 0.15
clip compressed 4.5 45 40 1
clip one_place 4.5 0.5 21 1

"$velamap" shoot_planner --camera_path "$here/../sail/camera.yml" --layout_path "$here/../sail/layout.yml" \
  --shape_path "$here/../sail/truth.csv" --Plan.distance 4.5 --Plan.arc 100 --Plan.num_views 80 \
  --Plan.speed 2 --output_path "$work/plan" --log_level error >"$work/plan.txt"
rsvg-convert --width 760 --background-color white "$work/plan/plan.svg" -o "$folder/plan.png"
