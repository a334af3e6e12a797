#!/usr/bin/env bash
# Configures and builds velamap.
# usage: workflows/build.sh PRESET [TARGET]
# PRESET: release, debug, ci (release, warnings are errors), sanitize (clang with the address and
# undefined-behaviour sanitizers) or tsan (clang with the thread sanitizer).
# TARGET: such as velamap; default all, with sanitizers the unit tests and the fuzz targets.
# VELAMAP_JOBS: parallel compilers, default one per core (each takes up to 1.5 GB of memory, with ci and
# sanitize 3 GB, because they compile more files at once).
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) echo "error: $1: unknown option; give a preset such as release" >&2; exit 2 ;;
esac
preset="${1:?usage: $0 PRESET [TARGET]}"
target=(${2:+--target "$2"})
cd "$(dirname "${BASH_SOURCE[0]}")/.."
echo "== build: preset $preset, in build/$preset"
cmake --preset "$preset"
cmake --build --preset "$preset" "${target[@]}" --parallel "${VELAMAP_JOBS:-$(nproc)}"
