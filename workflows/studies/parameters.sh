#!/usr/bin/env bash
# Measures area error, reprojection error, reconstruction ratio and the error against the truth as
# functions of the number of frames |S| = 2 n + 1, the skip s and the neighborhood m (thesis Figures
# 4.17 to 4.22), and of the parameters of section 4.3.2: the sigma of the weighted mean (m), the
# frequency threshold beta, and the distance up to which a marker is an inlier for RANSAC (m).
# usage: workflows/studies/parameters.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# NUM_FRAMES, SKIPS, NEIGHBORHOODS, SIGMAS, BETAS, INLIER_DISTANCES and CENTRAL_FRAMES give other
# values, e.g. "5 10 20".
# All results are means over the reconstructions around CENTRAL_FRAMES, as in section 4.3.3.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study parameters "$@"
if [[ $quick -eq 1 ]]; then
  base=(5 5 2)
  num_frames="3 5 7 9" skips="2 3 5 8" neighborhoods="0 1 2" central_frames="54"
  sigmas="0.1 0.6" betas="0.1 0.4" inlier_distances="0.05 0.3"
else
  base=(20 10 5)
  num_frames="5 10 15 20 25 28" skips="2 4 6 8 10 12 14" neighborhoods="0 1 2 3 4 5"
  central_frames="260 280 300 320 340"
  sigmas="0.1 0.2 0.4 0.6 1 2 5" betas="0.1 0.15 0.2 0.25 0.3 0.35 0.4"
  inlier_distances="0.05 0.075 0.1 0.15 0.2 0.3"
fi
read -ra num_frames <<<"${NUM_FRAMES-$num_frames}"
read -ra skips <<<"${SKIPS-$skips}"
read -ra neighborhoods <<<"${NEIGHBORHOODS-$neighborhoods}"
read -ra sigmas <<<"${SIGMAS-$sigmas}"
read -ra betas <<<"${BETAS-$betas}"
read -ra inlier_distances <<<"${INLIER_DISTANCES-$inlier_distances}"
read -ra central_frames <<<"${CENTRAL_FRAMES:-$central_frames}"

make_near_clip
csv="$work/parameters.csv"
echo "parameter,value,n,s,m,$(sail_header)" >"$csv"

# vary PARAMETER VALUE N S M [FRAME_REGISTRATOR_OPTION...]: writes a row with the means over the
# central frames.
vary() {
  local names=() frame name options
  for frame in "${central_frames[@]}"; do
    name="n$3_s$4_m$5_r$frame"
    if [[ $# -gt 5 ]]; then name="$1$2_$name"; fi
    names+=("$name")
    if [[ -d "$runs/$name" ]]; then continue; fi
    mapfile -t options < <(search "$3" "$4" "$5" "$frame")
    reconstruct near "$name" "${options[@]}" "${@:6}"
    grep -h 'the video is too short' "$runs/$name/log.txt" >&2 || true
  done
  { printf '%s,%s,%s,%s,%s' "${@:1:5}"; sail_row "${names[@]}"; } >>"$csv"
}

for n in "${num_frames[@]}"; do vary n $((2 * n + 1)) "$n" "${base[1]}" "${base[2]}"; done
for s in "${skips[@]}"; do
  # The neighborhoods of consecutive steps must not overlap.
  m=$(((s - 1) / 2 < base[2] ? (s - 1) / 2 : base[2]))
  vary s "$s" "${base[0]}" "$s" "$m"
done
for m in "${neighborhoods[@]}"; do vary m "$m" "${base[0]}" "${base[1]}" "$m"; done
# vary_option PARAMETER OPTION VALUE...: writes a row for each value of an option.
vary_option() {
  local value
  for value in "${@:3}"; do vary "$1" "$value" "${base[@]}" "--Registration.$2" "$value"; done
}
vary_option sigma mean_sigma "${sigmas[@]}"
vary_option beta frequency_threshold "${betas[@]}"
vary_option ransac ransac_max_error "${inlier_distances[@]}"

# chart PICTURE TITLE KEY...: plots the metrics, with one panel for each parameter that was varied.
chart() {
  local picture="$1" title="$2" keys=("${@:3}") parameter key curves
  {
    echo "set multiplot layout 2,3 title '$title'"
    for parameter in n s m sigma beta ransac; do
      grep -q "^$parameter," "$csv" || continue
      case "$parameter" in
        n) echo "set xlabel 'frames selected, |S| = 2 n + 1'" ;;
        s) echo "set xlabel 'skip s, frames'" ;;
        m) echo "set xlabel 'neighborhood m, frames'" ;;
        sigma) echo "set xlabel 'sigma of the weighted mean, m'" ;;
        beta) echo "set xlabel 'frequency threshold beta'" ;;
        ransac) echo "set xlabel 'largest distance of an inlier, m'" ;;
      esac
      curves=()
      for key in "${keys[@]}"; do
        curves+=("'$csv' using (strcol(1) eq '$parameter' ? column('value') : NaN):'$key' \
with linespoints title '${key//_/ }'")
      done
      echo "set yrange [0:*]; set offsets graph 0.05, graph 0.05, graph 0.1, 0"
      (IFS=,; echo "plot ${curves[*]}")
    done
    echo "unset multiplot"
  } | plot "$picture" 1500,1000
}
chart parameters_area.png "Marker area error, mm^2 (Figures 4.17, 4.20)" \
  area_error_mm2_mean area_error_mm2_std area_error_mm2_median area_error_mm2_max
chart parameters_reprojection.png "Reprojection error, px (Figures 4.18, 4.21)" \
  central_reprojection_error_px_mean central_reprojection_error_px_std \
  central_reprojection_error_px_median central_reprojection_error_px_max
chart parameters_ratio.png "Reconstruction ratio (Figures 4.19, 4.22)" reconstruction_ratio
chart parameters_truth.png "Error against the truth, RMS, mm" \
  distance_mm_rms distance_after_scaling_mm_rms
finish "$csv"
