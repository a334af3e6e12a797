#!/usr/bin/env bash
# Installs the Debian packages that velamap is built with. As root, or through sudo.
# usage: workflows/setup.sh [--with-clang | --with-tests]
# --with-clang: also what the preset sanitize is built with. --with-tests: also all that tests run.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache pkg-config colmap
  libopencv-dev libopencv-contrib-dev libeigen3-dev
  libavformat-dev libavcodec-dev libavutil-dev libswscale-dev libturbojpeg0-dev libexif-dev
  libheif-dev libcairo2-dev libpng-dev fonts-dejavu-core
  libsqlite3-dev libsqlitecpp-dev libyaml-cpp-dev libpugixml-dev
  libboost-program-options-dev libfmt-dev libspdlog-dev libceres-dev nlohmann-json3-dev jq
  libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev
  libocct-data-exchange-dev libassimp-dev libjs-three libjs-chart.js
  libgtest-dev libgmock-dev libbenchmark-dev
)
clang_packages=(
  clang libclang-rt-dev llvm clang-format-14  # llvm: names functions in the sanitizers' reports
  lld  # links the tests five times as fast
)
test_packages=(
  xvfb xauth imagemagick ffmpeg xdotool gnuplot-nox chromium poppler-utils librsvg2-bin
  python3-vtk9 gmsh  # readers of what others mesh
  man-db zsh mmdebstrap  # pages and completions that are installed; package.sh --try
  snakemake  # workflows/dataset; its test on Slurm wants slurmctld slurmd slurm-client munge, too
)

case "${1:-}" in
  "") ;;
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  --with-clang) packages+=("${clang_packages[@]}") ;;
  --with-tests) packages+=("${clang_packages[@]}" "${test_packages[@]}") ;;
  *) echo "usage: $0 [--with-clang | --with-tests]" >&2; exit 2 ;;
esac

is_installed() {
  [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "== setup: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "error: packages are missing (${missing[*]}); run this as root or install sudo" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "== setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --yes --no-install-recommends "${missing[@]}"
