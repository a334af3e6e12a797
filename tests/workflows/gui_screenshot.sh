#!/usr/bin/env bash
# Opens a reconstruction in COLMAP's own window on a virtual display and takes a picture of it.
#
#   gui_screenshot.sh DATABASE IMAGES MODEL PICTURE.png [ZOOM_CLICKS [DRAG_X DRAG_Y]]
#
# Fails unless the window opens and shows points and cameras: COLMAP draws cameras in red and points
# in their own colours on white.
set -euo pipefail

database=$1 images=$2 model=$3 picture=$4 zoom_clicks=${5:-0} drag_x=${6:-0} drag_y=${7:-0}

if [ -z "${VELAMAP_IN_XVFB:-}" ]; then
  VELAMAP_IN_XVFB=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$@"
fi

colmap gui --database_path "$database" --image_path "$images" --import_path "$model" \
  >"$picture.log" 2>&1 &
gui=$!
trap 'kill $gui 2>/dev/null || true' EXIT

for _ in $(seq 1 60); do
  sleep 0.5
  kill -0 $gui 2>/dev/null || { echo "colmap gui ended early, see $picture.log" >&2; exit 1; }
  xwininfo -root -tree 2>/dev/null | grep -q COLMAP && break
done
sleep 3

# The model view takes the left part of the window; a wheel click towards the view zooms in.
view_x=380 view_y=320
xdotool mousemove $view_x $view_y
[ "$zoom_clicks" -eq 0 ] || xdotool click --repeat "$zoom_clicks" --delay 20 4
if [ "$drag_x" -ne 0 ] || [ "$drag_y" -ne 0 ]; then
  xdotool mousedown 1
  for step in $(seq 1 20); do
    xdotool mousemove $((view_x + drag_x * step / 20)) $((view_y + drag_y * step / 20))
    sleep 0.02
  done
  xdotool mouseup 1
fi
sleep 1
import -window root "$picture"

# Pixels of the view that are neither white nor grey, and among them those of the camera's red.
count() { convert "$picture" -crop 740x515+5+60 +repage -fx "$1" -format '%[fx:int(mean*w*h+0.5)]' info:; }
colored=$(count 'saturation>0.3 ? 1 : 0')
red=$(count 'u.r>0.6 && u.g<0.35 && u.b<0.35 ? 1 : 0')
dark=$(count 'intensity<0.75 && saturation<0.25 ? 1 : 0')
echo "colored_pixels: $colored"
echo "camera_pixels: $red"
echo "dark_pixels: $dark"
[ "$red" -ge 20 ] || { echo "no cameras in the picture $picture" >&2; exit 1; }
[ "$dark" -ge 20 ] || { echo "no points in the picture $picture" >&2; exit 1; }
