#!/usr/bin/env bash
# Installs the packages, builds velamap with its tests and runs them.
# usage: workflows/test.sh [CTEST_ARGUMENT...]   such as --label-regex unit
# VELAMAP_PRESET: the build to test, default release; ci makes warnings errors; sanitize and tsan run the
# tests of the labels unit and cli under sanitizers, which takes hours.
# VELAMAP_COLMAP: the COLMAP that the tests run; default the one on the PATH.
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
preset="${VELAMAP_PRESET:-release}"
colmap="${VELAMAP_COLMAP:-}"
if [[ -n "$colmap" ]]; then
  [[ -x "$colmap" ]] || { echo "error: VELAMAP_COLMAP: $colmap is not a program" >&2; exit 2; }
  colmap="$(realpath "$colmap")"
fi
cd "$(dirname "${BASH_SOURCE[0]}")/.."

workflows/setup.sh --with-tests
workflows/build.sh "$preset" all
if [[ -n "$colmap" ]]; then
  programs="$(mktemp -d)"
  trap 'rm -rf "$programs"' EXIT
  ln -s "$colmap" "$programs/colmap"
  export PATH="$programs:$PATH"
fi
echo "== test: build/$preset"
# Three more than cores, because browsers, Slurm and other programs keep tests waiting.
ctest --preset "$preset" --parallel "$((${VELAMAP_JOBS:-$(nproc)} + 3))" "$@"
