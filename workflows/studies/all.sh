#!/usr/bin/env bash
# Runs all studies except camera_draws.sh, which takes longest, one after the other into the same
# work folder.
# usage: workflows/studies/all.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
set -euo pipefail

folder="$(dirname "${BASH_SOURCE[0]}")"
for study in marker_design parameters central_frames board_motions rigid_objects conditions accuracy \
  freeform repeatability found_cameras rolling_shutter sample_project shooting surface unknown_cameras; do
  "$folder/$study.sh" "$@"
done
