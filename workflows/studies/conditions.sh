#!/usr/bin/env bash
# Compares difficult conditions with the near clip, whose conditions are good (thesis Figures 4.27
# to 4.36): a change of wind, weak and strong reflections, a bad angle, a large distance. Also
# measures the motion of the sail relative to the hull between two central frames half a second
# apart (Figure 4.26).
# usage: workflows/studies/conditions.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# The wind changes halfway, at the central frame, and the shape is compared with the truth before
# and after the change. The motion is measured with long and short searches on a flapping clip and
# on the near clip. The sail of the near clip is rigid, so motion there is a measurement error.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study conditions "$@"
num_frames="$(short_clip_frames)"
central_frame=$((num_frames / 2))
if [[ $quick -eq 1 ]]; then
  long=(5 5 2) short=(3 2 0) far=(--scene sail --width 1280 --sail_scale 0.5 --distance 6)
else
  long=(20 5 2) short=(5 2 0) far=("${full_sail[@]}" --distance 12)
fi
mapfile -t options < <(search "${long[@]}" "$central_frame")

make_near_clip
make_clip wind "${sail[@]}" --num_frames "$num_frames" --trim_change_m 0.2
make_clip weak_reflection "${sail[@]}" --num_frames "$num_frames" --reflection 1
make_clip strong_reflection "${sail[@]}" --num_frames "$num_frames" --reflection 4
make_clip bad_angle "${sail[@]}" --num_frames "$num_frames" --angle_deg 60
make_clip far "${far[@]}" --num_frames "$num_frames"
make_clip flapping "${sail[@]}" --num_frames "$num_frames" --sail_motion_m 0.03

csv="$work/conditions.csv"
echo "condition,$(sail_header)" >"$csv"
# condition NAME CLIP: reconstructs a clip and writes its row.
condition() {
  reconstruct "$2" "$1" "${options[@]}"
  { printf '%s' "$1"; sail_row "$1"; } >>"$csv"
}
condition near near
condition wind_against_before wind
TRUTH="$clips/wind/truth_after.csv" condition wind_against_after wind
condition weak_reflection weak_reflection
condition strong_reflection strong_reflection
condition bad_angle bad_angle
condition far far
condition flapping flapping

# motion NAME CLIP N S M: measures the motion of every marker relative to the hull in half a second.
motion_csv="$work/conditions_motion.csv"
echo "clip,marker_id,of_hull,x_m,y_m,z_m,dx_mm,dy_mm,dz_mm,move_mm" >"$motion_csv"
motion() {
  local frame names=() from_to
  for frame in "$central_frame" $((central_frame + 15)); do
    mapfile -t from_to < <(search "${@:3}" "$frame")
    reconstruct "$2" "motion_$1_$frame" "${from_to[@]}"
    names+=("$runs/motion_$1_$frame/shape/shape.csv")
  done
  if [[ ! -f "${names[0]}" || ! -f "${names[1]}" ]]; then return; fi
  awk -f "$studies/align_part.awk" -v part=hull "${names[@]}" |
    sed "1d; s/^/$1,/" >>"$motion_csv"
}
motion flapping_long flapping "${long[@]}"
motion flapping_short flapping "${short[@]}"
motion rigid_long near "${long[@]}"
motion rigid_short near "${short[@]}"

# The mean motion of each line of markers, from the foot of the sail to its head, and of the hull.
lines_csv="$work/conditions_motion_lines.csv"
awk -F, '
  NR == FNR {
    if ($0 ~ /name: h[0-9]/) {
      match($0, /h[0-9]+/); line = substr($0, RSTART, RLENGTH)
      sub(/.*\[/, ""); sub(/\].*/, ""); gsub(/ /, "")
      count = split($0, ids, ",")
      for (i = 1; i <= count; i++) line_of[ids[i]] = line
      order[++num_lines] = line
    }
    next
  }
  FNR > 1 && $3 == 0 && $2 in line_of {
    sum[$1, line_of[$2]] += $10; n[$1, line_of[$2]]++
  }
  FNR > 1 && $3 == 1 { sum[$1, "hull"] += $10; n[$1, "hull"]++ }
  END {
    order[0] = "hull"
    print "line,flapping_long_mm,flapping_short_mm,rigid_long_mm,rigid_short_mm"
    for (i = 0; i <= num_lines; i++) {
      printf "%s", order[i]
      split("flapping_long flapping_short rigid_long rigid_short", clips, " ")
      for (c = 1; c <= 4; c++)
        printf ",%s", (clips[c], order[i]) in n ? \
          sprintf("%.3f", sum[clips[c], order[i]] / n[clips[c], order[i]]) : ""
      print ""
    }
  }' "$clips/flapping/layout.yml" "$motion_csv" >"$lines_csv"

plot conditions.png 1500,900 <<GNUPLOT
set multiplot layout 2,2 title "Hard conditions against the near clip (Figures 4.27 to 4.36)"
set style data histograms; set style fill solid 0.6; set xtics noenhanced rotate by -20
set yrange [0:*]
set title "reconstruction ratio"
plot '$csv' using 'reconstruction_ratio':xtic(1) notitle
set title "central reprojection error, px"
plot '$csv' using 'central_reprojection_error_px_mean':xtic(1) title 'mean', \
  '' using 'central_reprojection_error_px_max' title 'max'
set title "area error, mm^2"
set logscale y; unset yrange
plot '$csv' using 'area_error_mm2_mean':xtic(1) title 'mean', \
  '' using 'area_error_mm2_max' title 'max'
set title "RMS to the truth, mm"
plot '$csv' using 'distance_mm_rms':xtic(1) title 'metric', \
  '' using 'distance_after_scaling_mm_rms' title 'after scaling'
unset multiplot
GNUPLOT
plot conditions_motion.png <<GNUPLOT
set title "Motion against the hull in half a second, mean of a line (Figure 4.26)"
set ylabel "mm"; set logscale y
set xlabel "hull, lines of the sail from foot to top"
plot for [i=2:5] '$lines_csv' using i:xtic(1) with linespoints title columnheader(i) noenhanced
GNUPLOT
finish "$csv" "$lines_csv"
