#!/usr/bin/env bash
# Measures the smoothness and the error of the surface through the markers, on random sails with
# random noise and on rendered clips of a sail.
# usage: workflows/studies/surface.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# Writes surface.csv: the ratio of the error of the surface to the error of a marker, and the error
# of its curvature along the chord, at places between the outer markers. A row `random` is for
# num_draws sails with one noise of the markers; the ratio at a place is that of the RMS errors over
# the sails. A row with the name of a clip is for a single shape, relative to the RMS error of its
# markers along the normal. Curvatures are measured at least one marker away from luff and leech and
# one line away from foot and head.
# Writes surface_curvature.csv: the curvature along the chords of the clips, found and true.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study surface "$@"
surface_accuracy="$(find_program SURFACE_ACCURACY surface_accuracy tests/tools/surface_accuracy)"
csv="$work/surface.csv" curvature="$work/surface_curvature.csv"
if [[ $quick -eq 1 ]]; then num_draws=3 names=(sail_quick); else num_draws=40 names=(sail_1080p sail_4k); fi

"$surface_accuracy" --num_draws "$num_draws" --sigmas 0.1,0.3,1,3 >"$csv"
echo "clip,height_m,along,curvature,found_curvature,error_mm" >"$curvature"
for name in "${names[@]}"; do
  make_sail "$name" "$name"
  METHOD=global BACKEND=both EXACT_PRINT=1 reconstruct "$name" "$name"
  if [[ ! -f "$runs/$name/analysis.csv" ]]; then continue; fi
  clip=(--name "$name" --shape_path "$runs/$name/shape/shape.csv"
    --layout_path "$clips/$name/layout.yml" --reference_path "$clips/$name/truth.csv")
  "$surface_accuracy" "${clip[@]}" | sed 1d >>"$csv"
  "$surface_accuracy" "${clip[@]}" --profiles | sed "1d;s/^/$name,/" >>"$curvature"
done
finish "$csv"
