#!/usr/bin/env bash
# Installs the packages on a fresh Debian 12 machine, builds velamap and reconstructs the photographs of
# a cube with printed markers in sample_project.
# usage: workflows/sample.sh [WORKSPACE]   (default: ./workspace/cube)
# VELAMAP_PRESET: the build; default release.
set -euo pipefail

workspace="$(realpath --canonicalize-missing "${1:-workspace/cube}")"
preset="${VELAMAP_PRESET:-release}"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

workflows/setup.sh
workflows/build.sh "$preset" velamap
echo "== sample: reconstructing sample_project/cube into $workspace"
"build/$preset/workflows/velamap" automatic_reconstructor \
  --image_path sample_project/cube/images \
  --camera_path sample_project/cube/camera.yml \
  --layout_path sample_project/cube/layout.yml \
  --workspace_path "$workspace"
