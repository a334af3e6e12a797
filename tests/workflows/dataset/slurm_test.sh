#!/usr/bin/env bash
# Runs a small data set on a real Slurm of one node, one clip of it in parts. A job is cancelled in the
# middle: it is tried again, and the table is that of a local run.
# usage: slurm_test.sh REPOSITORY   (VELAMAP: the program)
set -euo pipefail

repository="$(realpath "$1")"
export VELAMAP="${VELAMAP:?}"
for program in snakemake munged slurmctld slurmd sbatch; do
  if ! PATH="$PATH:/usr/sbin" command -v "$program" >/dev/null; then
    echo "$program is not installed (Debian packages snakemake, slurmctld, slurmd, slurm-client)"
    exit 77
  fi
done
if [[ "$(id -u)" -ne 0 ]]; then
  echo "slurmd needs root"
  exit 77
fi
PATH="$PATH:/usr/sbin"
# shellcheck source-path=SCRIPTDIR source=one_node_slurm.sh
source "$(dirname "${BASH_SOURCE[0]}")/one_node_slurm.sh"
folder="$(mktemp -d)"
slurm_pids=()
# shellcheck disable=SC2317  # trap calls it
clean() {
  stop_slurm
  rm -rf "$folder"
}
trap clean EXIT
cd "$folder"
run="$repository/workflows/dataset/run.sh"
stylus="$repository/sample_project/stylus"
status=0

fail() {
  echo "$*"
  status=1
}

cp "$stylus/camera.yml" "$stylus/layout.yml" .
mkdir first second empty
cp "$stylus"/images/*{71,77,79,83,88,92}.jpg first
cp "$stylus"/images/*{98,01,14,16,18,20}.jpg second
cp "$repository/sample_project/guide/far.jpg" empty
quick="--ArucoDetection.estimate_formation 0"
{
  echo "name,clip,camera,layout,parts,options"
  for name in first second empty; do echo "$name,$name,camera.yml,layout.yml,,$quick"; done
  sail="$repository/sample_project/sail"
  echo "sail,$sail/clip.mp4,$sail/camera.yml,$sail/layout.yml,2,$quick --Video.last_frame 60 --Video.frame_step 3"
} >table.csv

code=0
"$run" table.csv here --cores 2 >here.txt 2>&1 || code=$?
[[ $code -eq 1 ]] || fail "exit $code of the local run: $(tail here.txt)"

start_slurm "$folder/slurm" >slurm.txt 2>&1 || { cat slurm.txt; exit 1; }
# The program, which cancels its own job in the first reconstruction. The signal may reach sleep before
# this script, which must not pass for a job that went on.
cat >cancelled_once <<BASH
#!/usr/bin/env bash
if [[ "\$1" == automatic_reconstructor && "\$2" != --help_all ]] && mkdir '$folder/cancelled' 2>/dev/null; then
  scancel "\$SLURM_JOB_ID"
  sleep 60 || exit 1
  touch '$folder/survived'
fi
exec '$VELAMAP' "\$@"
BASH
chmod +x cancelled_once
code=0
VELAMAP="$folder/cancelled_once" "$run" table.csv there --profile slurm >there.txt 2>&1 || code=$?
[[ $code -eq 1 ]] || fail "exit $code on Slurm: $(tail -n 30 there.txt)"
[[ -d cancelled && ! -e survived ]] || fail "no job was cancelled: $(tail -n 30 there.txt)"
# Three clips of two jobs each, a video whose two halves are imported, merged and reconstructed, and the
# job that was tried again.
num_jobs="$(find there/jobs -name 'slurm-*.log' | wc -l)"
[[ $num_jobs -eq 11 ]] || fail "Slurm has run $num_jobs jobs instead of 11"

# All but times and memory is equal.
figures() {
  python3 - "$1/dataset.csv" <<'PYTHON'
import csv, sys
for row in csv.DictReader(open(sys.argv[1], encoding="utf-8", newline="")):
    print({key: value for key, value in row.items() if "wall_s" not in key and key != "peak_memory_mb"})
PYTHON
}
[[ "$(figures here | grep -c "'exit_code': '0'")" -eq 3 ]] || fail "local table: $(figures here)"
diff <(figures here) <(figures there) || fail "the tables differ"
exit "$status"
