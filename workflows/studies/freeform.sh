#!/usr/bin/env bash
# Measures the error of the surface through markers that are on no lines, on bodies with exact truth
# and markers and noise at random, and the error of surfaces that libraries make through the same
# corners. CGAL takes part if freeform_accuracy was configured with -DVELAMAP_MEASURES_CGAL=ON
# (Debian package libcgal-dev).
# usage: workflows/studies/freeform.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# Writes freeform.csv: the distance from the body at places between the markers, over num_draws sets
# of markers; error_in_sigmas is the RMS error in stated sigmas, which only velamap has;
# lacking_percent of the places have no surface; cpu_s is the CPU time for one set, in seconds.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study freeform "$@"
freeform_accuracy="$(find_program FREEFORM_ACCURACY freeform_accuracy tests/tools/freeform_accuracy)"
if [[ $quick -eq 1 ]]; then num_draws=1; else num_draws=5; fi
"$freeform_accuracy" --num_draws "$num_draws" >"$work/freeform.csv"
finish "$work/freeform.csv"
