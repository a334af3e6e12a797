#!/usr/bin/env bash
# Runs two draws of camera_draws.sh, then a third: its table has to hold good results with the stated
# sigmas, and the first rows have to be kept.
# usage: camera_draws_test.sh FOLDER_OF_THE_STUDIES   (VELAMAP, RENDER_CLIP, CLIP_CORNERS: the programs)
set -euo pipefail

for program in colmap ffmpeg; do
  command -v "$program" >/dev/null || { echo "skipped: no $program" >&2; exit 77; }
done
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

"$1/camera_draws.sh" --quick --num_draws 2 "$work"
cp "$work/camera_draws.csv" "$work/first.csv"
# A row that is kept is not measured again, so that a changed figure stays.
sed -i '2s/[^,]*$/12345/' "$work/camera_draws.csv" "$work/first.csv"
"$1/camera_draws.sh" --quick --num_draws 3 "$work"
head -n 3 "$work/camera_draws.csv" | cmp - "$work/first.csv"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; num_columns = NF; next }
  {
    rows++
    bad = bad || NF != num_columns || $column["exit_code"] != 0 || $column["side_px"] < 10 ||
      $column["scale_error_percent"] == "" || $column["scale_error_percent"] ^ 2 > 1 ||
      $column["scale_sigma_percent"] <= 0 || $column["error_over_sigma"] == "" ||
      $column["side_bias_px"] == "" || $column["side_bias_px"] ^ 2 > 0.1 ||
      $column["num_false"] != 0 || $column["found_gamma"] == "" || $column["distance_mm_rms"] > 10
  }
  END { if (rows != 3 || bad) { print "unexpected figures"; exit 1 } }' "$work/camera_draws.csv"
grep -q '^all,all,3,3,' "$work/camera_draws_summary.csv"
if ls "$work"/runs/camera_draws/* >/dev/null 2>&1; then echo "draws were left behind"; exit 1; fi
