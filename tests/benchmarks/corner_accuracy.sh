#!/usr/bin/env bash
# Measures how well the corners of rendered markers are found: bias, scatter and stated sigma of the
# fitted corners, beside cv::cornerSubPix. One minute.
# usage: tests/benchmarks/corner_accuracy.sh [WORK_FOLDER]   (default: workspace/compare)
# BUILD: folder of the build (build/release). Writes corner_accuracy.csv.
set -euo pipefail
export LC_ALL=C

case "${1:-}" in
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) echo "error: $1: unknown option; give a work folder" >&2; exit 2 ;;
esac

repository="$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")"
program="${BUILD:-$repository/build/release}/tests/tools/corner_accuracy"
work="${1:-workspace/compare}"
if [[ ! -x "$program" ]]; then
  echo "error: $program is not built; cmake --build it, or set BUILD to the build's folder" >&2
  exit 2
fi
mkdir -p "$work"

# Both of the tool's Markdown tables have the same columns: drop the second heading and the rules.
csv="$work/corner_accuracy.csv"
{
  echo "side_px,blur_px,noise,tilt_deg,jpeg_quality,bend_deg,num_failed,num_markers,side_bias_px,\
side_bias_sigma_px,std_px,bound_px,error_over_sigma,subpix_side_bias_px,subpix_std_px"
  "$program" | awk -F' *[|] *' -v OFS=, '
    $2 ~ /^[0-9]/ {
      sub("/", ",", $8); sub(" ± ", ",", $9)
      print $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14
    }'
} >"$csv.part"
mv "$csv.part" "$csv"
echo "$csv"
