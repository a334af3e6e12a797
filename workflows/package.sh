#!/usr/bin/env bash
# Makes the Debian package velamap_VERSION_ARCHITECTURE.deb in the build folder.
# usage: workflows/package.sh [--try [DEB]]
# --try: then installs it in a fresh Debian 12 in a temporary folder (mmdebstrap; as root, with network)
# and reconstructs the sample there, without a compiler; with DEB, that package instead of a new one.
# VELAMAP_PRESET: the build; default release.
set -euo pipefail

preset="${VELAMAP_PRESET:-release}"
try=0 package=""
case "${1:-}" in
  "") ;;
  --help | -h) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
  --try) try=1 package="${2:+$(realpath -e "$2")}" ;;
  *) echo "usage: $0 [--try [DEB]]" >&2; exit 2 ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "$package" ]]; then
  workflows/setup.sh
  workflows/build.sh "$preset" velamap
  workflows/build.sh "$preset" install_files
  (cd "build/$preset" && cpack -G DEB)
  package="$(find "$PWD/build/$preset" -maxdepth 1 -name 'velamap_*.deb' -printf '%T@ %p\n' | sort -n |
    tail -n 1 | cut -d' ' -f2-)"
  echo "== package: $package"
fi
[[ $try -eq 1 ]] || exit 0

if [[ "$(id -u)" -ne 0 ]] || ! command -v mmdebstrap >/dev/null; then
  echo "error: --try needs root and the package mmdebstrap (apt-get install mmdebstrap)" >&2
  exit 2
fi
root="$(mktemp -d)"
trap 'rm -rf "$root"' EXIT
echo "== package: a fresh Debian 12 in $root"
mmdebstrap --variant=apt --quiet bookworm "$root/debian" "${VELAMAP_MIRROR:-http://deb.debian.org/debian}"
cp "$package" "$root/debian/velamap.deb"
if [[ -e /etc/resolv.conf ]]; then cp -L /etc/resolv.conf "$root/debian/etc/resolv.conf"; fi

start=$SECONDS
in_debian() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root chroot "$root/debian" "$@"; }
in_debian sh -e -c 'export DEBIAN_FRONTEND=noninteractive
  apt-get update; apt-get install --yes --no-install-recommends /velamap.deb' \
  >"$root/install.log" 2>&1 || { tail -n 20 "$root/install.log"; exit 1; }
echo "== package: installed in $((SECONDS - start)) s"
! in_debian sh -c 'command -v gcc || command -v c++' || { echo "error: a compiler came along"; exit 1; }
in_debian velamap version
in_debian /usr/share/velamap/workflows/sample.sh /sample
echo "== package: installed and sample reconstructed in $((SECONDS - start)) s"
