#!/usr/bin/env bash
# Measures what the workflow adds to its jobs, and what a second worker gains. Needs an idle machine.
#
# usage: workflows/dataset/measure.sh overhead|workers
#
#   overhead  JOBS jobs (default 200) that only wait SECONDS_PER_JOB (5), on WORKERS workers (8): the
#             time of all workers over the sum of the jobs
#   workers   the import and reconstruction of CLIPS clips (8), cut from sample_project/sail, with one
#             worker and with two
#
# VELAMAP: the program; the default is that of build/release, else that on the PATH.
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
fail() {
  echo "error: $*" >&2
  exit 2
}
here="$(dirname "$(realpath "${BASH_SOURCE[0]}")")"
# shellcheck source-path=SCRIPTDIR source=../find_program.sh
source "$here/../find_program.sh"
sail="$here/../../sample_project/sail"
REAL_VELAMAP="$(find_program VELAMAP velamap workflows/velamap)"
export REAL_VELAMAP
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# write_table CLIPS: rows that differ only in their names.
write_table() {
  echo "name,clip,camera,layout,options"
  for ((i = 1; i <= $1; ++i)); do
    echo "clip $i,$sail/clip.mp4,$sail/camera.yml,$sail/layout.yml,--Video.last_frame 60 --Video.frame_step 3"
  done
}

# wall_s OUTPUT WORKERS: runs the table and prints the seconds that took.
wall_s() {
  local begin
  begin="$(date +%s%N)"
  VELAMAP="$program" "$here/run.sh" "$folder/table.csv" "$1" --cores "$2" >"$folder/log.txt" 2>&1 ||
    { cat "$folder/log.txt" >&2; return 1; }
  awk -v ns="$(($(date +%s%N) - begin))" 'BEGIN { printf "%.2f", ns / 1e9 }'
}

# jobs_s OUTPUT: the sum over the jobs.
jobs_s() {
  python3 - "$1/dataset.csv" <<'PYTHON'
import csv, sys
with open(sys.argv[1], encoding="utf-8", newline="") as file:
    print(round(sum(float(row["wall_s"]) for row in csv.DictReader(file)), 2))
PYTHON
}

case "${1:-}" in
  overhead)
    jobs="${JOBS:-200}"
    workers="${WORKERS:-8}"
    export SECONDS_PER_JOB="${SECONDS_PER_JOB:-5}"
    program="$folder/waiting_velamap"
    cat >"$program" <<'BASH'
#!/usr/bin/env bash
if [[ "$1" == version || "${2:-}" == --help_all ]]; then exec "$REAL_VELAMAP" "$@"; fi
sleep "$SECONDS_PER_JOB"
echo '{}'
BASH
    chmod +x "$program"
    write_table $((jobs / 2)) >"$folder/table.csv"
    wall="$(wall_s "$folder/out" "$workers")"
    sum="$(jobs_s "$folder/out")"
    printf 'jobs: %d\nworkers: %d\njobs_s: %s\nwall_s: %s\n' "$jobs" "$workers" "$sum" "$wall"
    awk -v wall="$wall" -v sum="$sum" -v workers="$workers" \
      'BEGIN { printf "overhead_percent: %.2f\n", 100 * (workers * wall / sum - 1) }'
    ;;
  workers)
    program="$REAL_VELAMAP"
    write_table "${CLIPS:-8}" >"$folder/table.csv"
    one="$(wall_s "$folder/one" 1)"
    two="$(wall_s "$folder/two" 2)"
    printf 'wall_s_one_worker: %s\nwall_s_two_workers: %s\n' "$one" "$two"
    awk -v one="$one" -v two="$two" 'BEGIN { printf "times_as_fast: %.2f\n", one / two }'
    ;;
  *) fail "give overhead or workers; see --help" ;;
esac
