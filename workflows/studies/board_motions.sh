#!/usr/bin/env bash
# Measures the accuracy on a flat board with 12 markers of 40 mm, for the eight motions a to h
# (thesis section 4.1, Figures 4.4 to 4.7).
# usage: workflows/studies/board_motions.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# Step "detection": poses of single markers in single frames without an adjustment, as the mean over
# every fourth frame of the clip (every tenth with --quick).
# Step "adjusted": one bundle-adjusted reconstruction of the clip.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study board_motions "$@"
if [[ $quick -eq 1 ]]; then
  num_frames=30 step=10 adjusted=(5 2 0 15)
else
  num_frames=100 step=4 adjusted=(10 4 1 50)
fi
mapfile -t adjusted < <(search "${adjusted[@]}")

csv="$work/board_motions.csv"
echo "motion,step,num_markers,distance_error_mm,plane_error_mm,normal_error_deg,tangent_error_deg,\
scale_error_percent,rms_to_truth_mm" >"$csv"

# mean_part_metric KEY RUN...: prints the mean over the runs of a metric of the part `board`.
mean_part_metric() {
  local key="$1" run
  for run in "${@:2}"; do table_metric "$run" parts part board "$key"; done | mean
}

row() {
  local step="$1" runs_of_row=("${@:2}")
  printf '%s,%s,%s,%s,%s,%s,%s,%s,%s\n' "$motion" "$step" \
    "$(mean_metric num_markers "${runs_of_row[@]}")" \
    "$(mean_metric adjacent_distance_error_mm_mean "${runs_of_row[@]}")" \
    "$(mean_part_metric plane_error_mm_mean "${runs_of_row[@]}")" \
    "$(mean_part_metric normal_spread_deg_mean "${runs_of_row[@]}")" \
    "$(mean_part_metric tangent_spread_deg_mean "${runs_of_row[@]}")" \
    "$(mean_metric scale_error_percent "${runs_of_row[@]}")" \
    "$(mean_metric distance_mm_rms "${runs_of_row[@]}")" >>"$csv"
}

for motion in a b c d e f g h; do
  make_clip "board_$motion" --scene board --motion "$motion" --num_frames "$num_frames"
  names=()
  for ((frame = 0; frame < num_frames; frame += step)); do
    mapfile -t options < <(search 0 1 0 "$frame")
    ADJUST=0 reconstruct "board_$motion" "${motion}_$frame" "${options[@]}"
    names+=("${motion}_$frame")
  done
  row detection "${names[@]}"
  reconstruct "board_$motion" "${motion}_adjusted" "${adjusted[@]}"
  row adjusted "${motion}_adjusted"
done

{
  echo "set multiplot layout 2,2 title 'Board of 40 mm markers in eight motions (Figures 4.4 to 4.7)'"
  echo "set style data histograms; set style fill solid 0.6; set yrange [0:*]"
  for panel in 4:"distance error, mm" 5:"plane error, mm" 6:"normal error, degrees" \
    7:"tangent error, degrees"; do
    echo "set title '${panel#*:}'"
    echo "plot '< grep ,detection, $csv' using ${panel%%:*}:xtic(1) title 'detection', \
'< grep ,adjusted, $csv' using ${panel%%:*} title 'adjusted'"
  done
  echo "unset multiplot"
} | plot board_motions.png 1200,900
finish "$csv"
