#!/usr/bin/env bash
# Configures and builds velamap.
# usage: workflows/build.sh PRESET [TARGET]   (presets: release, debug, ci; target: all or velamap)
# VELAMAP_JOBS: parallel compilers, default one a core (each takes up to 1 GB of memory).
set -euo pipefail

preset="${1:?usage: $0 PRESET [TARGET]}"
target="${2:-all}"
cd "$(dirname "${BASH_SOURCE[0]}")/.."
echo "== build: preset $preset, in build/$preset"
cmake --preset "$preset"
cmake --build --preset "$preset" --target "$target" --parallel "${VELAMAP_JOBS:-$(nproc)}"
