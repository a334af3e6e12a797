#!/usr/bin/env bash
# Fuzzes every reader: tests/fuzz/run.sh MINUTES [READER...], MINUTES for each of them (0.2: a short
# look). VELAMAP_FUZZ_SEED: for the same inputs again. The corpus grows in build/fuzz/corpus. Files that
# were neither read nor refused are left in build/fuzz/findings; each goes, once mended, into
# tests/fuzz/findings/READER, which fuzz_test reads.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
[[ $# -ge 1 ]] || { echo "usage: tests/fuzz/run.sh MINUTES [READER...]" >&2; exit 2; }
seconds="$(awk -v minutes="$1" 'BEGIN { print int(60 * minutes) }')"
shift

workflows/build.sh sanitize fuzz_targets
export programs=build/sanitize/tests/fuzz build=build/fuzz seconds
# The libraries for CAD files keep their tables until the program ends.
export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1
mkdir -p "$build/findings"
"$programs/make_seeds" "$build/seeds"

readers=("$@")
if [[ ${#readers[@]} -eq 0 ]]; then
  for folder in "$build"/seeds/*/; do readers+=("$(basename "$folder")"); done
fi
fuzz() {  # READER
  local log="$build/findings/$1.log" status=0
  mkdir -p "$build/corpus/$1"
  "$programs/fuzz_$1" -seed="${VELAMAP_FUZZ_SEED:-0}" -max_total_time="$seconds" -timeout=30 \
    -rss_limit_mb=3000 -max_len=65536 -detect_leaks=0 -artifact_prefix="$build/findings/$1-" \
    "$build/corpus/$1" "$build/seeds/$1" > "$log" 2>&1 || status=1
  echo "$1: $(grep --only-matching --text 'Done [0-9]* runs in [0-9]* second' "$log" ||
    tail -n 1 "$log")"
  [[ $status -eq 0 ]] || echo "error: $1: see $log" >&2
  return "$status"
}
export -f fuzz
printf '%s\n' "${readers[@]}" |
  xargs --max-procs="${VELAMAP_JOBS:-$(nproc)}" -I '{}' bash -c 'fuzz "$1"' - '{}'
