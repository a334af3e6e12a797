#!/usr/bin/env bash
# Runs workflows/run_batch.sh over two short clips, and over a clip and a folder that holds none: a row
# for each, exit codes, and the summary of an earlier run, which stays.
# usage: run_batch_test.sh REPOSITORY   (VELAMAP: the program)
set -euo pipefail

repository="$(realpath "$1")"
export VELAMAP="${VELAMAP:?}"
for program in jq colmap; do
  command -v "$program" >/dev/null || { echo "$program is not on the PATH"; exit 77; }
done
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
export TMPDIR="$folder/tmp"  # where COLMAP leaves its logs
mkdir "$TMPDIR"
cd "$folder"
sail="$repository/sample_project/sail"
status=0

fail() {
  echo "$*"
  status=1
}

# batch CODE INPUT...: runs it on the inputs, which has to end so.
batch() {
  local expected="$1" code=0
  shift
  "$repository/workflows/run_batch.sh" --output_path "two words" --keep_going "$@" -- \
    --camera_path "$sail/camera.yml" --layout_path "$sail/layout.yml" --backend markers \
    --ArucoDetection.estimate_formation 0 --Video.last_frame 48 --Video.frame_step 8 \
    >out.txt 2>log.txt || code=$?
  [[ $code -eq $expected ]] || fail "exit $code of $*: $(tail -n 5 out.txt log.txt)"
}

# The summary as a line for each input: name, exit code, whether there is an error, images, ratio.
rows() {
  python3 - "two words/$1" <<'PYTHON'
import csv, sys
with open(sys.argv[1], encoding="utf-8", newline="") as file:
    for row in csv.DictReader(file):
        ratio = row["reconstruction_ratio"]
        print(row["input"], row["workspace"], row["exit_code"], bool(row["error"]),
              row["num_images"], bool(row["verdict"]), bool(ratio) and 0.5 < float(ratio) <= 1)
PYTHON
}

for name in first second; do cp "$sail/clip.mp4" "$name.mp4"; done
batch 0 first.mp4 second.mp4
expected="first.mp4 first 0 False 7 True True
second.mp4 second 0 False 7 True True"
[[ "$(rows summary.csv)" == "$expected" ]] || fail "summary: $(cat "two words/summary.csv")"
grep -q '^== summary: two words/summary.csv$' out.txt || fail "$(cat out.txt)"
[[ -s "two words/second/report.html" ]] || fail "no report"
! grep -q "$folder" "two words/summary.csv" || fail "the summary names folders"

# The clip that is there is not imported again, and the failure before it does not stop it.
mkdir empty
batch 2 empty first.mp4
[[ "$(rows summary.csv)" == "empty empty 2 True  False False
first.mp4 first 0 False 7 True True" ]] || fail "summary: $(cat "two words/summary.csv")"
[[ "$(rows summary.1.csv)" == "$expected" ]] || fail "the earlier summary is not summary.1.csv"

# A program that was named and is not there is not replaced by another one.
code=0
VELAMAP="$folder/no_such_velamap" "$repository/workflows/run_batch.sh" --output_path "$folder/new" \
  first.mp4 2>log.txt || code=$?
[[ $code -eq 2 && ! -e "$folder/new" ]] || fail "exit $code without the program that VELAMAP names"
grep -q '^error: VELAMAP: .*no_such_velamap is not a program' log.txt || fail "$(cat log.txt)"

# refused TEXT ARGUMENT...: exit 2 with the text, before anything is made.
refused() {
  local text="$1" code=0
  shift
  "$repository/workflows/run_batch.sh" "$@" >out.txt 2>log.txt || code=$?
  [[ $code -eq 2 && ! -e "$folder/new" ]] || fail "exit $code of $*"
  grep -q -e "$text" log.txt || fail "$* says: $(cat log.txt)"
}
refused "no input given" --output_path=new
refused "--workspace_path: a batch gives it itself" --output_path=new first.mp4 -- --workspace_path w
refused "--image_path=a: a batch gives it itself" --output_path=new first.mp4 -- --image_path=a
exit "$status"
