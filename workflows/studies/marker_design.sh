#!/usr/bin/env bash
# Measures from how far markers can be read, depending on their bits (9, 16 and 25), their border
# (one to three cells) and their side (6 to 12 cm), on clips of an action camera in 4K (thesis
# section 4.1).
# usage: workflows/studies/marker_design.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# DISTANCES gives other distances in m, e.g. "3 5 7".
# Writes marker_design.csv with the share of the markers found and the errors of their corners, from
# ten nearly frontal views that show every marker. The marker of the thesis has 9 bits, a border of
# one cell and a side of 10 cm; each series varies one of the three.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study marker_design "$@"
clip_corners="$(find_program CLIP_CORNERS clip_corners tests/tools/clip_corners)"
if [[ $quick -eq 1 ]]; then distances="4" width=1920; else distances="3 5 7 9 11" width=3840; fi
read -ra distances <<<"${DISTANCES-$distances}"

csv="$work/marker_design.csv"
echo "series,value,distance_m,side_px,found_percent,false,corner_error_px" >"$csv"

# seen SERIES VALUE BITS BORDER LENGTH_M: writes a row for each distance.
seen() {
  local distance name found
  for distance in "${distances[@]}"; do
    name="design_$3_$4_$5_$distance"
    make_clip "$name" --scene sail --camera action --tone_curve srgb --sail_scale 0.45 --crf 21 \
      --margin_sides 0.09 --num_frames 10 --fps 2 --drift_deg 10 --width "$width" \
      --dictionary_bits "$3" --border_bits "$4" --marker_length "$5" --distance "$distance"
    found="$runs/$name.txt"
    "$clip_corners" --clip_path "$clips/$name" --database_path "$clips/$name/database.db" \
      >"$found" 2>/dev/null || echo "num_markers: 0" >"$found"
    awk -v OFS=, -v series="$1" -v value="$2" -v distance="$distance" \
      -v possible="$((10 * $(num_true_markers "$name")))" '
      { of[$1] = $2 }
      END {
        print series, value, distance, of["side_px:"], 100 * (of["num_markers:"] - of["num_false:"]) / possible,
          of["num_false:"] + 0, of["corner_error_px:"]
      }' "$found" >>"$csv"
  done
}
for bits in 3 4 5; do seen bits $((bits * bits)) "$bits" 1 0.1; done
for border in 1 2 3; do seen border "$border" 3 "$border" 0.1; done
for length_cm in 6 8 10 12; do
  seen length "$length_cm" 3 1 "$(awk -v cm="$length_cm" 'BEGIN { print cm / 100 }')"
done

# panel SERIES TITLE UNIT VALUE...: prints gnuplot commands for a panel with a curve per value.
panel() {
  local value curves=()
  for value in "${@:4}"; do
    curves+=("'$csv' using (strcol(1) eq '$1' && column('value') == $value ? column('distance_m') : NaN)\
:'found_percent' with linespoints title '$value $3'")
  done
  echo "set title '$2'"
  (IFS=,; echo "plot ${curves[*]}")
}
{
  echo "set multiplot layout 1,3 title 'Markers found, % (section 4.1)'"
  echo "set yrange [0:105]; set xlabel 'distance, m'"
  panel bits "bits" bits 9 16 25
  panel border "border" cells 1 2 3
  panel length "side" cm 6 8 10 12
  echo "unset multiplot"
} | plot marker_design.png 1500,520
finish "$csv"
