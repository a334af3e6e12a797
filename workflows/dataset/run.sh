#!/usr/bin/env bash
# Reconstructs a data set: a table of clips (CSV) in, a workspace for each clip and one table of all
# results out, OUTPUT/dataset.csv and OUTPUT/dataset.html. What is there already is not computed again.
#
# usage: workflows/dataset/run.sh TABLE OUTPUT [--cores N] [--retry_failed] [SNAKEMAKE_OPTION...]
#
#   --cores N        jobs run side by side on N cores; the default is all
#   --retry_failed   compute the clips whose jobs have failed again
#   --profile slurm  on a cluster: workflows/dataset/profiles/slurm
#
# Exit code: 0 if every clip has its result, 1 if not (dataset.csv says which and why), 2 for bad input.
# README.md beside this script describes the table. VELAMAP: the program; the default is that of
# build/release, else that on the PATH.
set -euo pipefail

fail() {
  echo "error: ${*//[[:cntrl:]]/?}" >&2
  exit 2
}

here="$(dirname "$(realpath "${BASH_SOURCE[0]}")")"
# shellcheck source-path=SCRIPTDIR source=../find_program.sh
source "$here/../find_program.sh"
table=""
output=""
cores="$(nproc)"
on_cluster=0
retry_failed=0
only_shown=0
options=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --cores | -c) cores="${2:-}"; shift 2 || fail "--cores needs a number" ;;
    --cores=*) cores="${1#*=}"; shift ;;
    --retry_failed) retry_failed=1; shift ;;
    --profile)
      profile="${2:-}"; shift 2 || fail "--profile needs a folder, or slurm"
      [[ ! -d "$here/profiles/$profile" ]] || profile="$here/profiles/$profile"
      [[ -d "$profile" ]] || fail "--profile $profile: there is no such folder; give slurm or a folder"
      on_cluster=1
      options+=(--profile "$(realpath "$profile")")
      ;;
    --dry-run | --dryrun | -n) only_shown=1; options+=("$1"); shift ;;
    -*) options+=("$@"); break ;;
    *)
      if [[ -z "$table" ]]; then table="$1"; elif [[ -z "$output" ]]; then output="$1"
      else fail "$1: unexpected argument after TABLE and OUTPUT; put options of Snakemake last"; fi
      shift
      ;;
  esac
done
[[ -n "$table" && -n "$output" ]] || fail "TABLE or OUTPUT is missing; usage: run.sh TABLE OUTPUT"
[[ "$cores" =~ ^[1-9][0-9]{0,5}$ ]] || fail "--cores $cores: is not a number of cores; give 1 or more"
command -v snakemake >/dev/null ||
  fail "snakemake is not installed; run: apt-get install snakemake, or use workflows/run_batch.sh"
VELAMAP="$(find_program VELAMAP velamap workflows/velamap)"
export VELAMAP RETRY_FAILED="$retry_failed" PYTHONDONTWRITEBYTECODE=1

# A job has cores / clips threads, one at least; on a cluster, where many run, one.
[[ $on_cluster -eq 0 ]] || cores=1
# One run at a time; the lock ends with this process, even if it is killed.
lock() {
  exec 9>>"$output/.velamap_lock"
  flock --nonblock 9 || fail "$output: another run works there; wait for it"
}
[[ ! -f "$output/.velamap_dataset" ]] || lock
python3 "$here/make_jobs.py" "$table" "$output" "$cores"
lock

# Jobs also count against the memory of this machine; a cluster does its own accounting.
if [[ $on_cluster -eq 0 ]]; then
  memory_mb="$(awk '/^MemAvailable:/ { print int($2 / 1024) }' /proc/meminfo)"
  options=(--cores "$cores" --resources "mem_mb=$memory_mb" "${options[@]}")
fi
status=0
(cd "$output" && snakemake --snakefile "$here/Snakefile" --nolock --keep-going --rerun-incomplete \
  --rerun-triggers mtime --scheduler greedy --quiet rules "${options[@]}") >&2 || status=$?
[[ $only_shown -eq 0 ]] || exit "$status"
# Without results of all jobs, the table says which are missing.
python3 "$here/result_table.py" "$output" || status=1
exit "$status"
