#!/usr/bin/env bash
# Reconstructs the photographs of sample_project as their README says and compares the shapes with what
# is known of the objects.
# usage: workflows/studies/sample_project.sh [WORK_FOLDER]   (default: workspace/studies)
# Writes sample_project.csv, and sample_project.txt: what workflows/sample.sh prints at its end.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study sample_project "$@"
repository="$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")"
csv="$work/sample_project.csv"
echo "object,table,row,key,value" >"$csv"

# reconstruct_object OBJECT: with the defaults of automatic_reconstructor.
reconstruct_object() {
  local object="$repository/sample_project/$1"
  "$velamap" automatic_reconstructor --image_path "$object/images" \
    --camera_path "$object/camera.yml" --layout_path "$object/layout.yml" \
    --workspace_path "$runs/$1" --log_level warn >"$runs/$1.txt" 2>"$runs/$1.log" ||
    fail "$runs/$1.log says what went wrong"
}

# analyze_object OBJECT SHAPE_ANALYZER_OPTION...: adds the shape's metrics to the table, those of single
# markers and images left out.
analyze_object() {
  "$velamap" shape_analyzer --shape_path "$runs/$1/shape" --input_path "$runs/$1/sparse/0" \
    --layout_path "$repository/sample_project/$1/layout.yml" --part_planes 1 \
    --csv_path "$runs/$1.csv" --log_level error "${@:2}" >/dev/null
  awk -F, -v OFS=, -v object="$1" '
    NF == 4 && ($1 == "" || $1 == "parts" || $1 == "part_pairs") && $3 !~ /_ids$|_note$/ {
      print object, $0 }' "$runs/$1.csv" >>"$csv"
  awk -F': ' -v OFS=, -v object="$1" '$1 == "images_used" { print object, "", "", $1, $2 }' \
    "$runs/$1.txt" >>"$csv"
}

for object in cube stylus; do reconstruct_object "$object"; done
analyze_object cube
analyze_object stylus --reference_path "$repository/sample_project/stylus/reference.csv"
sed "s|$runs/cube|workspace/cube|g" "$runs/cube.txt" >"$work/sample_project.txt"
echo "$work/sample_project.txt"
finish "$csv"
