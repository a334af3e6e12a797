#!/usr/bin/env bash
# Fuzzes every reader: tests/fuzz/run.sh MINUTES [READER...], MINUTES for each of them (0.2: a short
# look). The corpus grows in build/fuzz/corpus. Files that were neither read nor refused are left in
# build/fuzz/findings; each goes, once mended, into tests/fuzz/findings/READER, which fuzz_test reads.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
[[ $# -ge 1 ]] || { echo "usage: tests/fuzz/run.sh MINUTES [READER...]" >&2; exit 2; }
seconds="$(awk -v minutes="$1" 'BEGIN { print int(60 * minutes) }')"
shift

workflows/build.sh fuzz
programs=build/fuzz/tests/fuzz
build=build/fuzz
mkdir -p "$build/findings"
"$programs/make_seeds" "$build/seeds"

readers=("$@")
if [[ ${#readers[@]} -eq 0 ]]; then
  for folder in "$build"/seeds/*/; do readers+=("$(basename "$folder")"); done
fi
# The libraries for CAD files keep their tables until the program ends.
export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1
found=()
for reader in "${readers[@]}"; do
  mkdir -p "$build/corpus/$reader"
  log="$build/findings/$reader.log"
  "$programs/fuzz_$reader" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=3000 \
    -max_len=65536 -detect_leaks=0 -artifact_prefix="$build/findings/$reader-" \
    "$build/corpus/$reader" "$build/seeds/$reader" > "$log" 2>&1 || found+=("$reader")
  echo "$reader: $(grep --only-matching --text 'Done [0-9]* runs in [0-9]* second' "$log" ||
    tail -n 1 "$log")"
done
for reader in "${found[@]}"; do echo "error: $reader: see build/fuzz/findings/$reader.log" >&2; done
[[ ${#found[@]} -eq 0 ]]
