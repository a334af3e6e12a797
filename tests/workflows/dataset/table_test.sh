#!/usr/bin/env bash
# Runs workflows/dataset over a few photographs and frames of sample_project, one input of which cannot
# be reconstructed: the tables say what came out, a second run computes nothing, a changed input is
# computed anew, and tables and folders that cannot be used are refused before any work.
# usage: table_test.sh REPOSITORY   (VELAMAP: the program)
set -euo pipefail

repository="$(realpath "$1")"
export VELAMAP="${VELAMAP:?}"
if ! command -v snakemake >/dev/null; then
  echo "snakemake is not on the PATH"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
export TMPDIR="$folder/tmp"  # where COLMAP leaves its logs
mkdir "$TMPDIR"
cd "$folder"
run="$repository/workflows/dataset/run.sh"
samples="$repository/sample_project"
status=0

fail() {
  echo "$*"
  status=1
}

# cell CLIP COLUMN: a cell of the result.
cell() {
  python3 - "$1" "$2" <<'PYTHON'
import csv, sys
rows = {row["name"]: row for row in csv.DictReader(open("out/dataset.csv", encoding="utf-8", newline=""))}
print(rows[sys.argv[1]][sys.argv[2]])
PYTHON
}
expect() {
  local got
  got="$(cell "$1" "$2")"
  [[ "$got" == "$3" ]] || fail "$1: $2 is '$got', expected '$3'"
}
# expect_between CLIP COLUMN LOW HIGH
expect_between() {
  awk -v got="$(cell "$1" "$2")" -v low="$3" -v high="$4" \
    'BEGIN { exit !(got != "" && got + 0 >= low && got + 0 <= high) }' ||
    fail "$1: $2 is '$(cell "$1" "$2")', expected $3 to $4"
}
run_dataset() {
  code=0
  "$run" table.csv out "$@" >out.txt 2>log.txt || code=$?
}

mkdir "two words"
cp "$samples"/stylus/images/*{71,77,79,83,88,92}.jpg "two words"
cp "$samples/stylus/camera.yml" "$samples/stylus/layout.yml" .
mkdir prior
cp "$samples/sail/truth.csv" prior/shape.csv
mkdir empty
cp "$samples/guide/far.jpg" empty/photo.jpg
name='odd "one" {x} <b>'
# As a spreadsheet saves it: byte order mark, semicolons, CRLF, a blank row, comma as decimal point.
quick="--ArucoDetection.estimate_formation 0"
{
  printf '\xef\xbb\xbfName;Clip;camera;layout;options;Central frames;Parts;sailing;wind\r\n'
  printf '"%s";two words;camera.yml;layout.yml;%s;;;x;4,5\r\n' "${name//\"/\"\"}" "$quick"
  printf 'no markers;empty;;layout.yml;%s;;;;6\r\n;;;;;;;;\r\n' "$quick"
  # An option of the method of the reconstruction, one of that of the sweep, and a folder.
  methods="--Registration.num_starts 3 --Registration.skip 8 --prior_shape_path prior"
  printf 'sail;%s;%s;%s;%s --Video.last_frame 60 --Video.frame_step 3;0:60:30;2;x;7\r\n' \
    "$samples"/sail/{clip.mp4,camera.yml,layout.yml} "$quick $methods"
} >table.csv
mkdir out

TIMEFORMAT='%U %S'  # CPU seconds, because other tests run beside this one
{ time run_dataset --cores 2; } 2>first_cpu_s.txt
[[ $code -eq 1 ]] || fail "exit $code of a data set with a failure: $(tail -n 20 log.txt)"
grep -q '^clips_with_result: 2$' out.txt || fail "$(cat out.txt log.txt)"
expect "$name" exit_code 0
expect "$name" num_markers 7
expect "$name" wind 4,5
expect_between "$name" num_images_used 5 6
expect_between "$name" reprojection_error_px_mean 0.02 0.5
expect_between "$name" peak_memory_mb 10 4000
expect "no markers" exit_code 1
expect "no markers" num_markers ""
[[ "$(cell "no markers" error)" == *"no marker"* ]] || fail "reason: $(cell "no markers" error)"
expect sail exit_code 0
expect sail sailing x
expect_between sail duration_s 1.95 2.1
expect_between sail reconstruction_ratio 0.8 1
expect_between sail area_error_percent_std 0.0001 2
expect_between sail scale_sigma_percent 0.001 1
expect_between sail num_central_frames 3 3
expect_between sail sweep_reconstruction_ratio_max "$(cell sail sweep_reconstruction_ratio_min)" 1
head -n 1 out/dataset.csv | grep -q ',[a-z0-9_]*_camber_percent,' || fail "no sections: $(head -n 1 out/dataset.csv)"
[[ -s "out/clips/$name/report.html" ]] || fail "no report of $name"
grep -q 'velamap marker_importer --image_path .*two words' out/jobs/odd*/import.log ||
  fail "the log has no line to copy"
grep -q 'velamap database_merger .*/part_1.db,.*/part_2.db' out/jobs/sail/import.log ||
  fail "the import of the sail was not split"
! grep -q "$folder" out/dataset.csv out/dataset.html || fail "the tables name folders"
for text in 'odd &quot;one&quot; {x} &lt;b&gt;' '<svg' '<td class="tag">•</td>' 'href="clips/sail/report.html"'; do
  grep -qF "$text" out/dataset.html || fail "dataset.html has no $text"
done
! grep -qE '<script|<b>|(src|href)="[a-z]+:' out/dataset.html || fail "dataset.html is not self-contained"
if command -v xmllint >/dev/null; then
  sed 's/^<!DOCTYPE html>//; s/<meta charset="utf-8">//' out/dataset.html | xmllint --noout - || fail "dataset.html"
fi

# A second run computes nothing, and takes less than a third of the first run's CPU time.
made() { find out/clips out/jobs "$@" -type f ! -name plan.json -printf '%P %T@\n' | sort; }
made out/dataset.* >before.txt
{ time run_dataset --cores 2; } 2>second_cpu_s.txt
[[ $code -eq 1 ]] || fail "exit $code of the second run"
made out/dataset.* | diff before.txt - || fail "the second run has written"
awk '{ cpu_s[NR] = $1 + $2 } END { exit !(NR == 2 && cpu_s[2] > 0 && cpu_s[2] < cpu_s[1] / 3) }' \
  first_cpu_s.txt second_cpu_s.txt ||
  fail "the second run took $(cat second_cpu_s.txt) s of CPU, the first $(cat first_cpu_s.txt) s"

# Another tag changes the tables alone, another photograph its clip alone.
made >before.txt
sed -i 's/;6\r/;8\r/' table.csv
run_dataset --cores 2
expect "no markers" wind 8
made | diff before.txt - || fail "a tag has computed something"
cp "$samples"/stylus/images/*98.jpg "two words"
run_dataset --cores 2
expect "$name" num_images 7
for clip in "no%20markers/" sail/; do
  diff <(grep "$clip" before.txt) <(made | grep "$clip") || fail "another clip has computed $clip"
done

# A job that was killed is tried again, and a clip that failed when asked to.
cat >killed_once <<'BASH'
#!/usr/bin/env bash
if [[ "$1" == automatic_reconstructor && "$2" != --help_all && ! -e killed ]]; then touch killed; kill -9 $$; fi
exec "$REAL_VELAMAP" "$@"
BASH
chmod +x killed_once
cp "$samples"/stylus/images/*{01,14}.jpg "two words"
export REAL_VELAMAP="$VELAMAP"
VELAMAP="$folder/killed_once" run_dataset --cores 2 --retry_failed
[[ -e out/killed ]] || fail "nothing was killed"
expect "$name" exit_code 0
expect "$name" num_images 9
[[ "$(grep -c '^cd ' out/jobs/no%20markers/import.log)" -eq 2 ]] || fail "--retry_failed has tried nothing"

# expect_refusal LOG EXPECTED
expect_refusal() {
  [[ $code -eq 2 ]] || fail "exit $code instead of a refusal"
  grep -q "$2" "$1" || fail "expected '$2': $(cat "$1")"
}

# refused TABLE_TEXT EXPECTED [OUTPUT]: exit 2, one line, and nothing is made.
refused() {
  printf '%b' "$1" >bad.csv
  code=0
  "$run" bad.csv "${3:-bad_out}" >refused.txt 2>&1 || code=$?
  [[ $code -eq 2 && "$(wc -l <refused.txt)" -eq 1 ]] || fail "exit $code for '$1': $(cat refused.txt)"
  grep -q "^error: .*$2" refused.txt || fail "'$1': $(cat refused.txt)"
  [[ ! -e bad_out ]] || fail "'$1' has made its output"
}
head="name,clip,layout,options,central_frames\n"
refused "${head}a,no.mp4,layout.yml,,\n" "line 2: clip no.mp4: there is no such"
refused "${head}a,empty,layout.yml,\n" "line 2: has 4 cells instead of 5"
refused "${head}a,empty,layout.yml,,\na,empty,layout.yml,,\n" "line 3: has the name a of line 2"
refused "${head}a/b,empty,layout.yml,,\n" "line 2: name 'a/b'"
refused "${head}a,empty,layout.yml,,10:0:1\n" "central_frames 10:0:1: is none of"
refused "${head}a,empty,layout.yml,--Video.frame_stp 2,\n" "velamap has no --Video.frame_stp"
refused "${head}a,empty,layout.yml,--workspace_path x,\n" "gives --workspace_path itself"
refused "${head}a,empty,,,\n" "layout: is empty"
refused "${head}a,empty,layout.yml,,all\n" "camera: is empty, and a sweep"
printf 'marker_length=0.1\n[Registration]\nskip=8 # frames\n' >project.ini
refused "${head}a,empty,,--project_path project.ini,all\n" "camera: is empty, and a sweep"
printf 'camera_path=camera.yml\nmarker_length=0.1\n' >relative.ini
refused "${head}a,empty,,--project_path relative.ini,all\n" "camera_path camera.yml would count from"
refused "name,clip,layout,parts\na,empty,layout.yml,2\n" "photographs have no parts"
for parts in 0 101 2.5 two; do
  refused "name,clip,layout,parts\na,$samples/sail/clip.mp4,layout.yml,$parts\n" "parts $parts: is not a number"
done
refused "${head}\"a,empty,layout.yml,,\n" "line 2: .*quotes"
refused "name,layout\n" "has no column clip"
refused "${head}a,empty,layout.yml,,\n" "is not a data set of this workflow" empty
refused "${head}a,$(printf 'x%.0s' {1..5000}),layout.yml,,\n" "line 2: clip xxx"
refused "${head}a,no\x1b[31m\xc2\x9b,layout.yml,,\n" 'clip no?\[31m?: there'
mkfifo pipe.csv
code=0
timeout 20 "$run" pipe.csv bad_out >refused.txt 2>&1 || code=$?
expect_refusal refused.txt 'a pipe or a device'
truncate --size 17M large.csv
code=0
"$run" large.csv bad_out >refused.txt 2>&1 || code=$?
expect_refusal refused.txt 'more than 16777216 bytes'
# Without Snakemake it says what to install.
mkdir bin
for program in bash dirname realpath nproc; do ln -s "$(command -v "$program")" bin; done
code=0
PATH="$folder/bin" "$run" table.csv bad_out >refused.txt 2>&1 || code=$?
expect_refusal refused.txt 'apt-get install snakemake'

# The legend of a plot with many clips lies within the picture, and no two of them look the same.
PYTHONPATH="$repository/workflows/dataset" PYTHONDONTWRITEBYTECODE=1 python3 - <<'PYTHON' || fail "plots.py"
import re
from plots import plot
for count in (1, 2, 8, 9, 16):
    picture = plot("t", "x", "y", {f"clip {i}": [(0, i, ""), (1, i, "")] for i in range(count)}, join=True)
    height = float(re.search(r'height="([^"]*)"', picture)[1])
    assert all(float(y) + 3.5 <= height for y in re.findall(r'cy="([^"]*)"', picture)), count
    looks = re.findall(r'fill="none" (stroke="[^"]*") stroke-width="1.5"([^/]*)/', picture)
    assert len(set(looks)) == count == len(looks), count
PYTHON

# What the workflow did not make stays: an edited result, and a folder in the place of a new clip.
echo note >>out/dataset.csv
run_dataset
expect_refusal log.txt 'dataset.csv: was changed'
grep -q '^note$' out/dataset.csv || fail "the edited table is gone"
rm out/dataset.csv
mkdir out/clips/new
sed -i 's/^no markers;/new;/' table.csv
run_dataset
expect_refusal log.txt 'clips/new: is there'
echo '[' >out/.velamap_dataset
run_dataset
expect_refusal log.txt 'velamap_dataset: is damaged'
exit "$status"
