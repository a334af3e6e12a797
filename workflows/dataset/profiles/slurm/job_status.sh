#!/usr/bin/env bash
# Tells Snakemake 7 how a job of Slurm stands: success, running or failed. Without an accounting
# database, Slurm forgets a job minutes after its end.
# usage: job_status.sh JOB_ID
set -euo pipefail

state="$(scontrol show job --oneliner "$1" 2>/dev/null | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p' || true)"
[[ -n "$state" ]] ||
  state="$(sacct --jobs "$1" --format state --noheader --parsable2 2>/dev/null | head -n 1 || true)"
case "$state" in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED | RESIZING) echo running ;;
  *) echo failed ;;
esac
