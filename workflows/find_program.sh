# shellcheck shell=bash
# Finds the programs that the scripts run. The scripts, which define fail(), source this file.

# find_program VARIABLE NAME PATH_IN_THE_BUILD: prints the path of a program: the one that $VARIABLE
# names, if that is set, else the one in the release build, else the one on the PATH.
find_program() {
  local built program
  built="$(dirname "${BASH_SOURCE[0]}")/../build/release/$3"
  if [[ -n "${!1:-}" ]]; then
    program="$(command -v "${!1}")" || fail "$1: ${!1} is not a program; correct it or unset it"
  elif [[ -x "$built" ]]; then
    program="$built"
  else
    program="$(command -v "$2")" ||
      fail "$2 is neither built (workflows/build.sh release) nor on the PATH; or set $1 to it"
  fi
  realpath "$program"
}
