#!/usr/bin/env bash
# Runs the lines of workflows/colmap.md as they stand there, on photographs of sample_project, and
# looks at what they leave.
# usage: colmap_lines_test.sh REPOSITORY   (VELAMAP: the program; VELAMAP_STYLUS_WORKSPACE: what
# automatic_reconstructor makes of the stylus)
set -euo pipefail

repository="$(realpath "$1")"
velamap="${VELAMAP:?}"
if ! command -v colmap >/dev/null; then
  echo "colmap is not on the PATH"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
export TMPDIR="$folder/tmp"  # where COLMAP leaves its logs
mkdir "$TMPDIR"
cd "$folder"
stylus="$repository/sample_project/stylus"
status=0

fail() {
  echo "$*"
  status=1
}

cp -r "${VELAMAP_STYLUS_WORKSPACE:?}" work
# Two clips: the first and the second half of the photographs.
images=("$stylus"/images/*)
half=$((${#images[@]} / 2))
mkdir first second
cp "${images[@]:0:half}" first
cp "${images[@]:half}" second
for part in first second; do
  "$velamap" marker_importer --image_path "$part" --camera_path "$stylus/camera.yml" \
    --layout_path "$stylus/layout.yml" --database_path "$part.db" --log_level error >/dev/null
done

sed -n "/^\`\`\`bash/,/^\`\`\`\$/{/^\`\`\`/d;p}" "$repository/workflows/colmap.md" >lines.sh
[[ "$(grep -c '^colmap ' lines.sh)" -ge 15 ]] || fail "workflows/colmap.md has no lines"
bash -e lines.sh >lines.log 2>&1 || { tail -n 30 lines.log; exit 1; }

# expect_model FOLDER MAX_ERROR_PX: all images, the 32 corners of 8 markers, and a small error.
expect_model() {
  colmap model_analyzer --path "$1" >analysis.txt 2>&1 || true
  awk -v images="${#images[@]}" -v max_error="$2" '
    { sub(/^.*\] /, "") }
    /^Registered images: / { registered = $3 }
    /^Points: / { points = $2 }
    /^Mean reprojection error: / { error = $4 + 0 }
    END { exit !(registered == images && points == 32 && error > 0 && error < max_error) }' \
    analysis.txt || fail "$1: $(cat analysis.txt)"
}
for model in mapped/0 triangulated adjusted aligned merged exported/bin exported/txt; do
  expect_model "$model" 0.5
done
# COLMAP's cameras are velamap's after the alignment, in metres.
error_m="$(sed -n 's/.*Alignment error: \([0-9.e-]*\) (mean).*/\1/p' lines.log)"
awk -v error_m="$error_m" 'BEGIN { exit !(error_m > 0 && error_m < 0.002) }' ||
  fail "aligned: the cameras are off by '$error_m' m"
"$velamap" shape_exporter --input_path exported/txt --layout_path "$stylus/layout.yml" \
  --shape_path shape --log_level error >/dev/null
"$velamap" shape_analyzer --shape_path shape --reference_path "$stylus/reference.csv" \
  --log_level error >analysis.txt
awk '/^distance_after_scaling_mm_rms: / { exit !($2 < 0.5) }' analysis.txt ||
  fail "the converted model is another shape: $(cat analysis.txt)"
undistorted=(dense/images/*)
[[ ${#undistorted[@]} -eq ${#images[@]} ]] || fail "dense: ${undistorted[*]}"
for file in model.ply model.points3D.wrl model.nvm model.bundle.out model.rd both.db; do
  [[ -s "exported/$file" || -s "$file" ]] || fail "$file is missing"
done
cameras=(exported/cam/*)
[[ ${#cameras[@]} -eq ${#images[@]} ]] || fail "CAM: ${cameras[*]}"
exit "$status"
