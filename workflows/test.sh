#!/usr/bin/env bash
# Installs the packages, builds velamap with its tests and runs them.
# usage: workflows/test.sh [CTEST_ARGUMENT...]   such as --label-regex unit
# VELAMAP_PRESET: the build to test, default release; ci makes warnings errors, sanitize runs the unit
# tests under the address and undefined-behaviour sanitizers.
set -euo pipefail

preset="${VELAMAP_PRESET:-release}"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

workflows/setup.sh --with-tests
workflows/build.sh "$preset"
echo "== test: build/$preset"
ctest --preset "$preset" --parallel 2 "$@"
