#!/usr/bin/env bash
# Measures the errors on rigid objects of known dimensions (thesis section 4.2): the board behind
# glass from 3, 5 and 7 m, and two walls at a right angle. The glass is filmed with the wide lens of
# the sail's clips, and at the two larger distances also with a narrower lens of 68 degrees.
# usage: workflows/studies/rigid_objects.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study rigid_objects "$@"
if [[ $quick -eq 1 ]]; then
  width=1280 num_frames=30 distances=(1 1.5 2)
  mapfile -t options < <(search 5 2 0)
else
  width=3840 num_frames=60 distances=(3 5 7)
  mapfile -t options < <(search 14 2 0)
fi

csv="$work/rigid_objects.csv"
echo "object,step,num_markers,reconstruction_ratio,plane_error_mm_mean,plane_error_mm_max,\
distance_error_mm_mean,distance_error_mm_max,angle_deg,area_error_percent_mean,\
reprojection_error_px_mean,scale_error_percent,rms_to_truth_mm,rms_after_scaling_mm" >"$csv"

# parts_metric RUN KEY mean|max: prints the mean or the maximum of a metric over the parts.
parts_metric() {
  local file="$runs/$1/analysis.csv"
  [[ -f "$file" ]] || return 0
  awk -F, -v key="$2" -v how="$3" '
    $1 == "parts" && $3 == key { sum += $4; n++; if ($4 > max) max = $4 }
    END { if (n) printf "%.6g", how == "max" ? max : sum / n }' "$file"
}

# row OBJECT STEP RUN: writes a row of the table.
row() {
  local key
  {
    printf '%s,%s' "$1" "$2"
    for key in num_markers reconstruction_ratio; do printf ',%s' "$(metric "$3" "$key")"; done
    printf ',%s' "$(parts_metric "$3" plane_error_mm_mean mean)" \
      "$(parts_metric "$3" plane_error_mm_max max)" \
      "$(metric "$3" adjacent_distance_error_mm_mean)" \
      "$(metric "$3" adjacent_distance_error_mm_max)" \
      "$(awk -F, '$1 == "part_pairs" && $3 == "angle_deg" { print $4 }' \
        "$runs/$3/analysis.csv" 2>/dev/null)"
    for key in area_error_percent_mean reprojection_error_px_mean scale_error_percent \
      distance_mm_rms distance_after_scaling_mm_rms; do
      printf ',%s' "$(metric "$3" "$key")"
    done
    printf '\n'
  } >>"$csv"
}

# reconstruct_middle CLIP RUN: reconstructs around the middle frame or, if that fails, around the
# central frame that frame_registrator selects.
reconstruct_middle() {
  reconstruct "$1" "$2" "${options[@]}" --Registration.central_frame $((num_frames / 2))
  if [[ ! -f "$runs/$2/analysis.csv" ]]; then reconstruct "$1" "$2" "${options[@]}"; fi
}

# study_object CLIP: writes the rows of the results before and after the bundle adjustment.
study_object() {
  ADJUST=0 reconstruct_middle "$1" "$1_seed"
  row "$1" seed "$1_seed"
  reconstruct_middle "$1" "$1_adjusted"
  row "$1" adjusted "$1_adjusted"
}

# study_glass NAME DISTANCE LENS: studies a clip of the board behind glass.
study_glass() {
  make_clip "$1" --scene board --lens "$3" --width "$width" --distance "$2" --motion d \
    --num_frames "$num_frames"
  study_object "$1"
}

for distance in "${distances[@]}"; do study_glass "glass_${distance}m" "$distance" wide; done
for distance in "${distances[@]:1}"; do
  study_glass "glass_${distance}m_narrow" "$distance" webcam
done
make_clip walls --scene walls --width "$width" --num_frames "$num_frames"
study_object walls

plot rigid_objects.png 1200,500 <<GNUPLOT
set multiplot layout 1,2 title "Rigid objects, mean errors before and after adjustment (section 4.2)"
set style data histograms; set style fill solid 0.6; set logscale y
set xtics noenhanced rotate by -30
set title "plane error, mm"
plot '< grep ,seed, $csv' using 5:xtic(1) title 'seed', \
  '< grep ,adjusted, $csv' using 5 title 'adjusted', 0.5 with lines dashtype 2 title 'thesis: below'
set title "error of adjacent distances, mm"
plot '< grep ,seed, $csv' using 7:xtic(1) title 'seed', \
  '< grep ,adjusted, $csv' using 7 title 'adjusted', 1 with lines dashtype 2 title 'thesis: below'
unset multiplot
GNUPLOT
finish "$csv"
