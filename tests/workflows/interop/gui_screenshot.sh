#!/usr/bin/env bash
# Opens a reconstruction in COLMAP's own window on a virtual display and takes a picture of it.
#
#   gui_screenshot.sh DATABASE IMAGES MODEL PICTURE.png [ZOOM [DRAG_X DRAG_Y [SHRINK]]]
#
# ZOOM clicks of the wheel bring the view nearer (more than 22 cut the model off), a drag of so many
# pixels turns it, SHRINK clicks with Alt make the cameras smaller: COLMAP draws them for a scene of
# tens of units. Fails unless the window opens and shows points and cameras: cameras are red, and
# points are what grows when Ctrl and the wheel make points larger.
set -euo pipefail

database=$1 images=$2 model=$3 picture=$4
zoom=${5:-0} drag_x=${6:-0} drag_y=${7:-0} shrink=${8:-0}

if [ -z "${VELAMAP_IN_XVFB:-}" ]; then
  VELAMAP_IN_XVFB=1 exec xvfb-run -a -s "-screen 0 1024x600x24" "$0" "$@"
fi

work=$(mktemp -d)
gui=
trap '[ -z "$gui" ] || kill "$gui" 2>/dev/null || true; rm -rf "$work"' EXIT

QT_QPA_PLATFORM=xcb colmap gui --database_path "$database" --image_path "$images" \
  --import_path "$model" >"$picture.log" 2>&1 &
gui=$!

# The model view takes the left part of the window.
view=740x515+5+60 view_x=375 view_y=317

# Writes a picture of the view only.
shoot() { import -window root -crop "$view" +repage "$1"; }

# Writes a picture once two in a row are the same: the view is drawn to the end.
shoot_at_rest() {
  local before="" now
  for _ in $(seq 1 20); do
    sleep 0.3
    shoot "$1"
    now=$(convert "$1" rgb:- | cksum)
    [ "$now" != "$before" ] || return 0
    before=$now
  done
}

# Pixels of the camera's red: red above and green and blue below their limits.
count_cameras() {
  convert "$1" -separate \
    '(' -clone 0 -threshold 60% ')' \
    '(' -clone 1 -threshold 35% -negate ')' \
    '(' -clone 2 -threshold 35% -negate ')' \
    -delete 0-2 -evaluate-sequence min -format '%[fx:int(mean*w*h+0.5)]' info:
}

# The view is black until it is drawn for the first time, then white with cameras.
for attempt in $(seq 1 100); do
  sleep 0.2
  kill -0 $gui 2>/dev/null || { echo "colmap gui ended early, see $picture.log" >&2; exit 1; }
  shoot "$work/first.png"
  [ "$(count_cameras "$work/first.png")" -eq 0 ] || break
  [ "$attempt" -lt 100 ] || { echo "colmap gui draws no cameras" >&2; exit 1; }
done

xdotool mousemove $view_x $view_y
[ "$zoom" -eq 0 ] || xdotool click --repeat "$zoom" --delay 20 4
[ "$shrink" -eq 0 ] || xdotool keydown alt click --repeat "$shrink" --delay 20 5 keyup alt
if [ "$drag_x" -ne 0 ] || [ "$drag_y" -ne 0 ]; then
  xdotool mousedown 1
  for step in $(seq 1 20); do
    xdotool mousemove $((view_x + drag_x * step / 20)) $((view_y + drag_y * step / 20))
    sleep 0.02
  done
  xdotool mouseup 1
fi

shoot_at_rest "$work/small.png"
xdotool keydown ctrl click --repeat 6 --delay 20 4 keyup ctrl
shoot_at_rest "$work/large.png"
import -window root "$picture"

cameras=$(count_cameras "$work/large.png")
points=$(compare -metric AE "$work/small.png" "$work/large.png" null: 2>&1 || true)
echo "camera_pixels: $cameras"
echo "point_pixels: $points"
[ "$cameras" -ge 20 ] || { echo "no cameras in the picture $picture" >&2; exit 1; }
[ "$points" -ge 20 ] || { echo "no points in the picture $picture" >&2; exit 1; }
