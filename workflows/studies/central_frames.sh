#!/usr/bin/env bash
# Measures the reconstruction ratio around many central frames (thesis Figure 4.24) and the
# histogram of the markers' areas (Figure 4.23).
# usage: workflows/studies/central_frames.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# A single run of central_frame_sweeper makes all reconstructions. With START=1, each adjustment
# starts from the result of its neighbour. BACKEND selects the adjustment (default: colmap).
# Near the ends of the clip, frames exist on one side only, so that fewer are found (num_images).
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study central_frames "$@"
if [[ $quick -eq 1 ]]; then
  mapfile -t options < <(search 5 5 2)
  step=10
else
  mapfile -t options < <(search 20 10 5)
  step=30
fi

make_near_clip
frames=()
for ((frame = step; frame < $(near_clip_frames); frame += step)); do frames+=("$frame"); done
layout=(--layout_path "$clips/near/layout.yml" --log_level warn)
"$velamap" central_frame_sweeper --database_path "$clips/near/database.db" "${layout[@]}" \
  --central_frames "$(IFS=,; echo "${frames[*]}")" --backend "${BACKEND:-colmap}" \
  --warm_start "${START:-0}" --models_path "$runs/models" \
  --output_path "$work/central_frames_sweep.csv" "${options[@]}" >"$runs/log.txt" 2>&1 ||
  fail "$runs/log.txt says what went wrong"
csv="$work/central_frames.csv"
areas="$work/central_frames_areas.csv"
histogram="$work/central_frames_histogram.csv"
echo "central_frame,$(sail_header)" >"$csv"
echo "central_frame,marker_id,area_mm2" >"$areas"

# areas_of FRAME SHAPE_CSV: prints the area of every whole marker, which is half the norm of the
# cross product of its diagonals.
areas_of() {
  awk -F, -v frame="$1" '
    /^[0-9]/ && $2 >= 1 { p[$1, $2, "x"] = $3; p[$1, $2, "y"] = $4; p[$1, $2, "z"] = $5; ids[$1] }
    END {
      for (id in ids) {
        whole = 1
        for (corner = 1; corner <= 4; corner++) whole = whole && ((id, corner, "x") in p)
        if (!whole) continue
        ax = p[id, 3, "x"] - p[id, 1, "x"]; bx = p[id, 4, "x"] - p[id, 2, "x"]
        ay = p[id, 3, "y"] - p[id, 1, "y"]; by = p[id, 4, "y"] - p[id, 2, "y"]
        az = p[id, 3, "z"] - p[id, 1, "z"]; bz = p[id, 4, "z"] - p[id, 2, "z"]
        cx = ay * bz - az * by; cy = az * bx - ax * bz; cz = ax * by - ay * bx
        printf "%d,%d,%.2f\n", frame, id, 1e6 * sqrt(cx * cx + cy * cy + cz * cz) / 2
      }
    }' "$2" | sort -t, -k2n
}

# analyze FRAME: compares a result with the truth. The row of a frame without a result stays empty;
# the table of the sweep gives the reason.
analyze() {
  local model
  model="$runs/models/frame_$(printf '%06d' "$1")"
  if [[ ! -f "$model/shape.csv" ]]; then return; fi
  mkdir -p "$runs/r$1"
  "$velamap" shape_analyzer --shape_path "$model/shape.csv" --input_path "$model/sparse" \
    --reference_path "$clips/near/truth.csv" --csv_path "$runs/r$1/analysis.csv" \
    "${layout[@]}" >>"$runs/log.txt" 2>&1 || fail "$runs/log.txt says what went wrong"
  areas_of "$1" "$model/shape.csv" >>"$areas"
}

for frame in "${frames[@]}"; do
  analyze "$frame"
  { printf '%s' "$frame"; sail_row "r$frame"; } >>"$csv"
done

# The best frame has the highest ratio and, among equals, the smallest area error.
best="$(awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
  $column["reconstruction_ratio"] != "" {
    ratio = $column["reconstruction_ratio"]; error = $column["area_error_mm2_mean"]
    if (best == "" || ratio > best_ratio || (ratio == best_ratio && error < best_error)) {
      best = $1; best_ratio = ratio; best_error = error
    }
  }
  END { print best }' "$csv")"
[[ -n "$best" ]] || fail "no central frame gave a result"
echo "== central_frames: best central frame: $best"

# Histogram of the areas in bins of 20 mm^2, for the best reconstruction and for all of them. A bin
# is named by its middle.
awk -F, -v best="$best" -v width=20 '
  NR == 1 { next }
  {
    bin = int($3 / width)
    all[bin]++; num_all++
    if ($1 == best) { of_best[bin]++; num_best++ }
    if (num_all == 1 || bin < first) first = bin
    if (num_all == 1 || bin > last) last = bin
  }
  END {
    print "area_mm2,share_of_best_percent,share_of_all_percent"
    for (bin = first; bin <= last; bin++)
      printf "%g,%.2f,%.2f\n", (bin + 0.5) * width, 100 * of_best[bin] / num_best,
        100 * all[bin] / num_all
  }' "$areas" >"$histogram"

num_wanted=$((2 * options[1] + 1))
plot central_frames.png <<GNUPLOT
set title "Reconstruction ratio by central frame (Figure 4.24)"
set xlabel "central frame"
set yrange [0:1.05]
plot '$csv' using 1:'reconstruction_ratio' with linespoints title 'reconstruction ratio', \
  '' using 1:(column('num_images') / $num_wanted) with linespoints \
  title 'part of the $num_wanted frames found'
GNUPLOT
plot central_frames_histogram.png <<GNUPLOT
set title "Areas of the reconstructed markers, printed 10000 mm^2 (Figure 4.23)"
set xlabel "area, mm^2"
set ylabel "share, %"
set style fill solid 0.5
set boxwidth 20
plot '$histogram' using 1:2 skip 1 with boxes title 'central frame $best', \
  '' using 1:3 skip 1 with steps linewidth 2 title 'all central frames'
GNUPLOT
finish "$csv" "$histogram"
