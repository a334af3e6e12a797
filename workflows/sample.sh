#!/usr/bin/env bash
# Installs the packages on a fresh Debian 12 machine, builds velamap, and reconstructs two objects of
# sample_project: photographs of a cube with printed markers, and a clip of a sail. Where velamap is
# installed (/usr/share/velamap), nothing is built: the program on the PATH is used.
# usage: workflows/sample.sh [FOLDER]   (default: ./workspace; workspaces FOLDER/cube and FOLDER/sail)
# VELAMAP_PRESET: the build; default release. VELAMAP: an existing program to use instead of a build.
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) echo "error: $1: unknown option; give the folder of the workspaces" >&2; exit 2 ;;
esac
folder="$(realpath --canonicalize-missing "${1:-workspace}")"
preset="${VELAMAP_PRESET:-release}"
velamap="${VELAMAP:-}"
if [[ -n "$velamap" ]]; then velamap="$(realpath "$velamap")"; fi
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "$velamap" && ! -f CMakeLists.txt ]]; then
  velamap="$(command -v velamap)" || { echo "error: velamap is not on the PATH" >&2; exit 2; }
elif [[ -z "$velamap" ]]; then
  workflows/setup.sh
  workflows/build.sh "$preset" velamap
  velamap="build/$preset/workflows/velamap"
fi

# reconstruct NAME PICTURES: an object of sample_project.
reconstruct() {
  echo "== sample: $1: reconstructing sample_project/$1/$2 into $folder/$1"
  "$velamap" automatic_reconstructor --image_path "sample_project/$1/$2" \
    --camera_path "sample_project/$1/camera.yml" --layout_path "sample_project/$1/layout.yml" \
    --workspace_path "$folder/$1"
}
reconstruct cube images
reconstruct sail clip.mp4

echo "== sample: the sail against its truth"
"$velamap" shape_analyzer --shape_path "$folder/sail/shape" --input_path "$folder/sail/sparse/0" \
  --layout_path sample_project/sail/layout.yml --reference_path sample_project/sail/truth.csv \
  --log_level error |
  grep -E '^(scale_error_percent|distance(_after_scaling)?_(mm_rms|sigma_mm)):'
echo "== sample: open these"
echo "report: $folder/sail/report.html (in a browser)"
echo "sections: $folder/sail/shape/section_profiles.svg"
echo "surface: $folder/sail/shape/surface.step (CAD), surface.ply (MeshLab, Blender)"
echo "cube: $folder/cube/report.html"
