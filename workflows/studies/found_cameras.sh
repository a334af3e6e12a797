#!/usr/bin/env bash
# Compares the calibrations that came with real pictures with the cameras that are found without
# one. The pictures of an object are divided into two halves. The camera is found in one half and
# then held fixed in the other half, as is the calibration of the file; the camera that predicts the
# pictures better, which it has not seen, is nearer to the truth.
# usage: workflows/studies/found_cameras.sh [--quick] [WORK_FOLDER]   (default: workspace/studies)
# Writes found_cameras.csv with one row per half: the focal length of the file, the camera that this
# half gives, and for the file's camera and the one that the other half gives the reprojection error
# and the mean error of the markers' sides. --quick leaves out the video.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

begin_study found_cameras "$@"

# halve FOLDER: links the photographs, in the order of their names, alternately into $runs/halves/a
# and b.
halve() {
  local image half=a
  rm -rf "$runs/halves"
  mkdir -p "$runs/halves/a" "$runs/halves/b"
  while IFS= read -r image; do
    ln -s "$image" "$runs/halves/$half/"
    if [[ $half == a ]]; then half=b; else half=a; fi
  done < <(printf '%s\n' "$1"/* | sort -V)
}

# run_half RUN OPTION...: reconstructs a half with the options of the object.
run_half() {
  local run="$runs/$1"
  mkdir -p "$run"
  "$velamap" automatic_reconstructor --workspace_path "$run/workspace" --layout_path "$object_layout" \
    --backend markers "${@:2}" >"$run/log.txt" 2>&1 || fail "$run/log.txt says what went wrong"
  "$velamap" shape_analyzer --shape_path "$run/workspace/shape" --layout_path "$object_layout" \
    --input_path "$run/workspace/sparse/0" --csv_path "$run/analysis.csv" --log_level error \
    >"$run/analysis.txt"
}

# file_focal CAMERA_FILE: prints the mean focal length of an OpenCV calibration.
file_focal() {
  awk '/^camera_matrix/ { inside = 1 }
    inside && sub(/.*data: *\[/, "") { split($0, m, ","); printf "%.2f", (m[1] + m[5]) / 2; exit }' "$1"
}

csv="$work/found_cameras.csv"
echo "object,half,file_focal_px,model,focal_px,focal_sigma_px,error_file_px,error_found_px,\
side_error_file_mm,side_error_found_mm" >"$csv"

# compare NAME LAYOUT CAMERA_FILE OPTION...: compares the cameras of an object. The arrays half_a
# and half_b are the options that select the pictures of each half.
compare() {
  local name="$1" camera="$3" half other fixed
  object_layout="$2"
  for half in a b; do
    local -n pictures="half_$half"
    run_half "$name/$half" "${pictures[@]}" "${@:4}"
  done
  for half in a b; do
    local -n pictures="half_$half"
    other=b
    if [[ $half == b ]]; then other=a; fi
    fixed=("${pictures[@]}" --MarkerAdjustment.refine_calibration 0 "${@:4}")
    run_half "$name/${half}_file" --camera_path "$camera" "${fixed[@]}"
    run_half "$name/${half}_found" --camera_path "$runs/$name/$other/workspace/camera.yml" "${fixed[@]}"
    echo "$name,$half,$(file_focal "$camera"),$(found_focal "$name/$half"),$(
      metric "$name/${half}_file" reprojection_error_px_mean),$(
      metric "$name/${half}_found" reprojection_error_px_mean),$(
      metric "$name/${half}_file" side_error_mm_mean),$(
      metric "$name/${half}_found" side_error_mm_mean)" >>"$csv"
  done
}

# compare() reads half_a and half_b by name.
# shellcheck disable=SC2034
{
  stylus="$repository/sample_project/stylus"
  halve "$stylus/images"
  half_a=(--image_path "$runs/halves/a")
  half_b=(--image_path "$runs/halves/b")
  compare stylus "$stylus/layout.yml" "$stylus/camera.yml"
  if [[ $quick -eq 0 ]]; then
    # The frames of a video that follow each other are alike, so the halves follow each other.
    board="$repository/tests/data/board_video"
    half_a=(--image_path "$board/cam_0.mp4" --Video.last_frame 28)
    half_b=(--image_path "$board/cam_0.mp4" --Video.first_frame 29)
    compare board_video "$board/layout.yml" "$board/camera.yml" --ArucoDetection.inverted 1
  fi
}
finish "$csv"
