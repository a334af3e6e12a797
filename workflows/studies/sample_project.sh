#!/usr/bin/env bash
# Reconstructs the objects of sample_project as their README describes and compares the shapes with
# the known dimensions of the objects.
# usage: workflows/studies/sample_project.sh [WORK_FOLDER]   (default: workspace/studies)
# Writes sample_project.csv, and sample_project.txt with the output of workflows/sample.sh for the
# sail.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study sample_project "$@"
csv="$work/sample_project.csv"
echo "object,table,row,key,value" >"$csv"

VELAMAP="$velamap" "$repository/workflows/sample.sh" "$runs" >"$runs/sample.txt" 2>"$runs/sample.log" ||
  fail "$runs/sample.log says what went wrong"
stylus="$repository/sample_project/stylus"
"$velamap" automatic_reconstructor --image_path "$stylus/images" --camera_path "$stylus/camera.yml" \
  --layout_path "$stylus/layout.yml" --workspace_path "$runs/stylus" --log_level warn \
  >"$runs/stylus.txt" 2>"$runs/stylus.log" || fail "$runs/stylus.log says what went wrong"
# part HEADING: prints the output of the sample under a heading.
part() { awk -v of="$1" '/^== sample: / { within = index($0, "== sample: " of) == 1; next } within' "$runs/sample.txt"; }
for object in cube sail; do part "$object:" >"$runs/$object.txt"; done

# analyze_object OBJECT SHAPE_ANALYZER_OPTION...: adds the metrics of a shape to the table, except
# those of single markers and images.
analyze_object() {
  "$velamap" shape_analyzer --shape_path "$runs/$1/shape" --input_path "$runs/$1/sparse/0" \
    --layout_path "$repository/sample_project/$1/layout.yml" \
    --csv_path "$runs/$1.csv" --log_level error "${@:2}" >/dev/null
  awk -F, -v OFS=, -v object="$1" '
    NF == 4 && ($1 == "" || $1 == "parts" || $1 == "part_pairs") && $3 !~ /_ids$|_note$/ {
      print object, $0 }' "$runs/$1.csv" >>"$csv"
  awk -v OFS=, -v object="$1" '$1 == "images:" { print object, "", "", "images_used", $2 " of " $4 }' \
    "$runs/$1.txt" >>"$csv"
}

analyze_object cube --part_planes 1
analyze_object stylus --part_planes 1 --reference_path "$repository/sample_project/stylus/reference.csv"
analyze_object sail --reference_path "$repository/sample_project/sail/truth.csv"
sed -n '/^== sample: sail/,$p' "$runs/sample.txt" | sed "s|$runs|workspace|g" >"$work/sample_project.txt"
echo "$work/sample_project.txt"
finish "$csv"
