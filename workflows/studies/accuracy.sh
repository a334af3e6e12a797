#!/usr/bin/env bash
# Measures the error of the metric result on rendered clips and on photographs of known objects. The
# thesis's method comes first; then its steps are replaced by those of velamap, one after the other.
# usage: workflows/studies/accuracy.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# CLIPS and WAYS select a subset, e.g. CLIPS="walls board" WAYS="global_both". CAMERA: films the
# rendered clips with another camera than render_clip's default (render_clip --camera), as clips of
# other names.
#
#   way             corners  registration  adjustment
#   thesis          subpix   thesis        colmap
#   edge            edge     thesis        colmap
#   global          edge     global        colmap
#   global_markers  edge     global        markers
#   global_both     edge     global        both, which is velamap's default
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study accuracy "$@"
camera=() suffix=""
if [[ -n "${CAMERA:-}" ]]; then camera=(--camera "$CAMERA") suffix="_$CAMERA"; fi
read -ra ways <<<"${WAYS:-thesis edge global global_markers global_both}"
read -ra clips_of_study <<<"${CLIPS:-walls board sail_1080p sail_4k cube stylus board_video aprilgrid}"
if [[ $quick -eq 1 ]]; then
  num_frames=40
  read -ra clips_of_study <<<"${CLIPS:-walls board board_video aprilgrid}"
else
  num_frames=120
fi

keys=(num_markers reconstruction_ratio scale_error_percent distance_mm_rms
  distance_sigma_mm distance_after_scaling_mm_rms distance_after_scaling_sigma_mm
  corners_above_4_sigma_percent correlation_factor reprojection_error_px_mean
  area_error_percent_mean)
csv="$work/accuracy.csv"
echo "clip,way,$(IFS=,; echo "${keys[*]}"),scale_sigma_percent,outliers_percent,angle_deg" >"$csv"

# link_real NAME FOLDER IMAGES: makes a clip of real pictures of an object with known geometry.
link_real() {
  local folder="$clips/$1"
  mkdir -p "$folder"
  if [[ "$2" != "$folder" ]]; then cp "$2/camera.yml" "$2/layout.yml" "$folder/"; fi
  cp "$2/reference.csv" "$folder/truth.csv"
  echo "$3" >"$folder/images.txt"
}

# The geometry of the cube is exact only within a face, so each face has its own reference. The
# reference of the clip itself is face0.
link_cube() {
  local folder="$clips/cube" face
  mkdir -p "$folder/truth"
  for face in 0 1 2 3 4 5; do
    awk -F, -v group="face$face" -v OFS=, '
      NR == 1 { print "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part" }
      $1 == group { print $2, $3, $4, $5, $6, "", "", "", 0, group }' \
      "$repository/sample_project/cube/known_geometry.csv" >"$folder/truth/face$face.csv"
  done
  cp "$folder/truth/face0.csv" "$folder/reference.csv"
  cp "$repository/sample_project/cube/"{camera,layout}.yml "$folder/"
  link_real cube "$folder" "$repository/sample_project/cube/images"
}

make_clip_of_study() {
  local folder
  folder="$(folder_of "$1")"
  case "$1" in
    walls) make_clip "$folder" "${camera[@]}" --scene walls --width 1920 --num_frames "$num_frames" ;;
    board) make_clip "$folder" "${camera[@]}" --scene board --motion d --num_frames "$num_frames" ;;
    sail_*) make_sail "$1" "$folder" "${camera[@]}" ;;
    cube) link_cube ;;
    stylus) link_real stylus "$repository/sample_project/stylus" "$repository/sample_project/stylus/images" ;;
    board_video)
      link_real board_video "$repository/tests/data/board_video" \
        "$repository/tests/data/board_video/cam_0.mp4"
      ;;
    aprilgrid)
      link_real aprilgrid "$repository/tests/data/aprilgrid" \
        "$repository/tests/data/aprilgrid/images"
      ;;
    *) fail "CLIPS: $1 is unknown" ;;
  esac
}

# folder_of CLIP: the name of the folder that make_clip_of_study makes.
folder_of() {
  case "$1" in
    walls) echo "walls_1080p$suffix" ;;
    board) echo "board_720p$suffix" ;;
    sail_*) echo "$1$suffix" ;;
    *) echo "$1" ;;
  esac
}

# detections CLIP CORNERS: makes the database of a clip unless it is current, and prints its path.
# make_clip has found the edges of a rendered clip already, the default.
detections() {
  local folder database images more=()
  folder="$clips/$(folder_of "$1")"
  database="$folder/$2.db"
  if [[ "$2" == edge && -f "$folder/import.txt" ]]; then
    echo "$folder/database.db"
    return
  fi
  images="$folder/clip.mp4"
  if [[ -f "$folder/images.txt" ]]; then images="$(cat "$folder/images.txt")"; fi
  if [[ "$1" == board_video ]]; then more=(--ArucoDetection.inverted 1); fi
  if ! is_current "$database"; then
    rm -f "$database"
    "$velamap" marker_importer --image_path "$images" --camera_path "$folder/camera.yml" \
      --layout_path "$folder/layout.yml" --database_path "$database" --log_level error \
      --ArucoDetection.corner_refinement "$2" "${more[@]}" >"$folder/$2.txt"
  fi
  echo "$database"
}

# study CLIP WAY: reconstructs a clip in one way and writes its rows.
study() {
  local corners=edge method=global backend=colmap exact_print=0 face run="$1_$2"
  case "$2" in
    thesis) corners=subpix method=thesis ;;
    edge) method=thesis ;;
    global) ;;
    global_markers) backend=markers ;;
    global_both) backend=both ;;
    *) fail "WAYS: $2 is unknown" ;;
  esac
  case "$1" in
    walls | board | sail_*) exact_print=1 ;;
  esac
  DATABASE="$(detections "$1" "$corners")" METHOD="$method" BACKEND="$backend" \
    EXACT_PRINT="$exact_print" \
    reconstruct "$(folder_of "$1")" "$run"
  if [[ "$1" == cube ]]; then
    for face in 0 1 2 3 4 5; do face_row "$2" "$face"; done
  else
    row "$1" "$2" "$run"
  fi
}

# adjustment_figures RUN: prints the sigma of the scale and the share of outliers, both in percent,
# from the first command that reports them.
adjustment_figures() {
  awk '
    $1 == "scale_sigma:" && sigma == "" { sigma = $2 }
    $1 == "outliers_removed:" && outliers == "" && $4 > 0 { outliers = sprintf("%.6g", 100 * $2 / $4) }
    END { printf "%s,%s", sigma, outliers }' "$runs/$1/log.txt"
}

# row CLIP WAY RUN [RUN_OF_THE_ADJUSTMENT]: writes a row of the table.
row() {
  local key
  {
    printf '%s,%s' "$1" "$2"
    for key in "${keys[@]}"; do printf ',%s' "$(metric "$3" "$key")"; done
    printf ',%s' "$(adjustment_figures "${4:-$3}")"
    printf ',%s\n' "$(awk -F, '$1 == "part_pairs" && $3 == "angle_deg" { print $4; exit }' \
      "$runs/$3/analysis.csv" 2>/dev/null)"
  } >>"$csv"
}

# face_row WAY FACE: compares the cube with the reference of one face and writes the row.
face_row() {
  local run="$runs/cube_$1" face_run="$runs/cube_$1_face$2"
  mkdir -p "$face_run"
  if [[ -f "$run/analysis.csv" ]]; then
    "$velamap" shape_analyzer --shape_path "$run/shape" --input_path "$run/metric" \
      --reference_path "$clips/cube/truth/face$2.csv" --csv_path "$face_run/analysis.csv" \
      --log_level error >"$face_run/log.txt"
  fi
  row "cube_face$2" "$1" "cube_$1_face$2" "cube_$1"
}

for clip in "${clips_of_study[@]}"; do
  make_clip_of_study "$clip"
  for way in "${ways[@]}"; do study "$clip" "$way"; done
done
finish "$csv"
