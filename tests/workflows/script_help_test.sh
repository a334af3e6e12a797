#!/usr/bin/env bash
# Checks that scripts print their usage on --help before they look for programs or start their work, and
# that those which take a folder or a preset refuse unknown options.
# usage: script_help_test.sh REPOSITORY
set -euo pipefail

repository="$(realpath "$1")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export VELAMAP="$folder/no_such_velamap" BUILD="$folder/no_such_build"
status=0

fail() {
  echo "$*"
  status=1
}

for script in workflows/{sample,test,build,package,setup,run_batch}.sh workflows/dataset/{run,measure}.sh \
  tests/benchmarks/corner_accuracy.sh; do
  for option in --help -h; do
    [[ "$script$option" != workflows/run_batch.sh-h ]] || continue
    code=0
    "$repository/$script" "$option" >out.txt 2>log.txt || code=$?
    [[ $code -eq 0 ]] || fail "$script $option: exit $code: $(head -n 3 log.txt)"
    grep -q "^usage: .*$script" out.txt || fail "$script $option prints no usage: $(head -n 3 out.txt)"
    ! grep -q '^== ' out.txt || fail "$script $option starts its work"
  done
done

for script in workflows/{sample,build}.sh tests/benchmarks/corner_accuracy.sh; do
  code=0
  "$repository/$script" --odd >out.txt 2>log.txt || code=$?
  [[ $code -eq 2 ]] || fail "$script --odd: exit $code"
  grep -q '^error: --odd: unknown option' log.txt || fail "$script --odd says: $(head -n 3 log.txt)"
done
[[ "$(ls)" == $'log.txt\nout.txt' ]] || fail "scripts have made $(ls)"
exit "$status"
