#!/usr/bin/env bash
# All studies of thesis chapter 4, one after the other, and the accuracy of what velamap puts in place
# of its steps, into one work folder.
# usage: workflows/studies/all.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
set -euo pipefail

folder="$(dirname "${BASH_SOURCE[0]}")"
for study in parameters central_frames board_motions rigid_objects conditions accuracy repeatability; do
  "$folder/$study.sh" "$@"
done
