#!/usr/bin/env bash
# Checks the standard deviations on objects for which no truth is exact enough. The photographs of
# an object are divided into two halves, each half is reconstructed by itself, and the difference of
# the two shapes is compared with what their covariances predict. The shapes are aligned with a
# scale, because the error of the scale is common to both. For the same reason, a print that differs
# from its layout has no effect.
# usage: workflows/studies/repeatability.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study repeatability "$@"
csv="$work/repeatability.csv"
echo "object,num_points,difference_mm,predicted_mm,ratio,scale_difference_percent" >"$csv"

# halve IMAGES: links the images, in the order of their names, alternately into halves a and b.
halve() {
  local image half=a
  rm -rf "$runs/halves"
  mkdir -p "$runs/halves/a" "$runs/halves/b"
  for image in "$1"/*; do
    ln -s "$image" "$runs/halves/$half/"
    if [[ $half == a ]]; then half=b; else half=a; fi
  done
}

# reconstruct_half NAME HALF: makes the shape from the database. The commands are joined by &&
# because bash ignores `set -e` before a `||`.
reconstruct_half() {
  local run="$runs/$1_$2" inputs
  inputs=(--database_path "$runs/$1.$2.db" --layout_path "$clips/$1/layout.yml" --log_level warn)
  mkdir -p "$run" &&
    "$velamap" frame_registrator "${inputs[@]}" --output_path "$run/seed" \
      --Registration.method global &&
    "$velamap" bundle_adjuster "${inputs[@]}" --backend both --input_path "$run/seed" \
      --output_path "$run/adjusted" &&
    "$velamap" shape_exporter --input_path "$run/adjusted" --output_path "$run/metric" \
      --shape_path "$run/shape" "${inputs[@]:2}"
}

# compare NAME HALF OTHER: compares the shape and model of a half with the shape of the other half.
compare() {
  "$velamap" shape_analyzer --shape_path "$runs/$1_$2/shape" --input_path "$runs/$1_$2/metric" \
    --reference_path "$runs/$1_$3/shape" --csv_path "$runs/$1_$2/halves.csv" --log_level error \
    >"$runs/$1_$2/halves.txt"
}

for object in "$repository/sample_project/cube" "$repository/sample_project/stylus" \
  "$repository/tests/data/aprilgrid"; do
  name="$(basename "$object")"
  mkdir -p "$clips/$name"
  cp "$object/layout.yml" "$clips/$name/"
  halve "$object/images"
  for half in a b; do
    "$velamap" marker_importer --image_path "$runs/halves/$half" \
      --camera_path "$object/camera.yml" --layout_path "$object/layout.yml" \
      --database_path "$runs/$name.$half.db" --log_level error >"$runs/$name.$half.txt"
    reconstruct_half "$name" "$half" >"$runs/${name}_$half.log" 2>&1 ||
      fail "$runs/${name}_$half.log says what went wrong"
  done
  compare "$name" a b
  compare "$name" b a
  awk -F, -v OFS=, -v name="$name" '
    $1 == "" { value[FILENAME, $3] = $4 }
    END {
      a = ARGV[1]; b = ARGV[2]; sigma = "distance_after_scaling_sigma_mm"
      predicted = sqrt(value[a, sigma] ^ 2 + value[b, sigma] ^ 2)
      difference = value[a, "distance_after_scaling_mm_rms"]
      print name, value[a, "num_points"], difference, predicted, difference / predicted,
        value[a, "scale_error_percent"]
    }' "$runs/${name}_a/halves.csv" "$runs/${name}_b/halves.csv" >>"$csv"
done
finish "$csv"
