#!/usr/bin/env bash
# Installs the packages, builds velamap with its tests and runs all of them.
# usage: workflows/test.sh [CTEST_ARGUMENT...]   such as --label-regex unit
# VELAMAP_PRESET: the build to test, default release (debug has the sanitizers, ci -Werror).
set -euo pipefail

preset="${VELAMAP_PRESET:-release}"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

workflows/setup.sh --with-tests
workflows/build.sh "$preset"
echo "== test: all tests of build/$preset"
ctest --preset "$preset" --parallel 2 "$@"
