#!/usr/bin/env bash
# Runs parameters.sh with two values of n and one of each option on a small clip and checks its table.
# usage: studies_test.sh FOLDER_OF_THE_STUDIES   (VELAMAP, RENDER_CLIP: the programs)
set -euo pipefail

for program in colmap ffmpeg; do
  command -v "$program" >/dev/null || { echo "skipped: no $program" >&2; exit 77; }
done
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

NUM_FRAMES="5 9" SKIPS="" NEIGHBORHOODS="" SIGMAS=0.6 BETAS=0.3 INLIER_DISTANCES=0.1 "$1/parameters.sh" --quick "$work"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
  {
    rows++
    bad = bad || $1 == "n" && $column["num_images"] != $2 || $column["reconstruction_ratio"] < 0.9 ||
      $column["area_error_percent_mean"] > 2 || $column["reprojection_error_px_mean"] > 0.3 ||
      $column["scale_error_percent"] ^ 2 > 1 || $column["distance_mm_rms"] > 10 ||
      $column["distance_mm_rms"] == ""
  }
  END { if (rows != 5 || bad) { print "unexpected figures"; exit 1 } }' "$work/parameters.csv"
if command -v gnuplot >/dev/null; then
  for picture in "$work"/parameters_{area,reprojection,ratio,truth}.png; do
    [[ -s "$picture" ]] || { echo "$picture is missing or empty"; exit 1; }
  done
fi
