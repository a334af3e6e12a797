#!/usr/bin/env bash
# Installs into a temporary folder, as `cmake --install` does for a user: the program runs there, every
# command has a manual page with all its options, bash and zsh complete, scripts find the program, and
# the uninstall target leaves nothing.
# usage: install_test.sh BUILD_FOLDER REPOSITORY
set -euo pipefail

build="$1"
repository="$2"
root="$(mktemp -d)"
manifest="$build/install_manifest.txt"
# The list of a real installation from this build stays.
if [[ -f "$manifest" ]]; then cp "$manifest" "$root/saved_manifest"; fi
# shellcheck disable=SC2317  # trap calls it
restore() {
  rm -f "$manifest"
  if [[ -f "$root/saved_manifest" ]]; then cp "$root/saved_manifest" "$manifest"; fi
  rm -rf "$root"
}
trap restore EXIT
status=0

fail() {
  echo "$*"
  status=1
}

prefix="$root/usr"
cmake --install "$build" --prefix "$prefix" >"$root/install.log"
share="$prefix/share"
PATH="$prefix/bin:$PATH"
[[ "$(velamap version | head -n 1)" == "velamap: "* ]] || fail "the installed program does not run"

for file in doc/velamap/copyright doc/velamap/CHANGELOG.md velamap/LICENSE velamap/CITATION.cff \
  velamap/README.md velamap/reconstruct/README.md velamap/sample_project/sail/clip.mp4; do
  [[ -s "$share/$file" ]] || fail "share/$file is missing"
done

# Every link between the pages holds.
while read -r page; do
  while read -r target; do
    [[ -e "$(dirname "$page")/$target" ]] || fail "${page#"$share/"}: there is no $target"
  done < <(grep -o '](\([^)#]*\)' "$page" | sed 's/^](//' | grep -v -e '^http' -e '^$')
done < <(find "$share/velamap" -name '*.md')

# Pages: one for the program and each command, no fault of roff, every option of --help_all.
mapfile -t commands < <(velamap help | sed -n 's/^  \([a-z_]*\)  *[a-z].*/\1/p' | grep -v -E '^(velamap|help)$')
[[ ${#commands[@]} -ge 13 ]] || fail "help lists ${#commands[@]} commands"
page() { gzip -dc "$share/man/man1/$1.1.gz"; }
for name in velamap "${commands[@]/#/velamap-}"; do
  [[ -s "$share/man/man1/$name.1.gz" ]] || { fail "no page $name"; continue; }
  if command -v man >/dev/null; then
    faults="$(page "$name" | LC_ALL=C.UTF-8 MANROFFSEQ='' man --warnings --encoding=UTF-8 --local-file - 2>&1 >/dev/null)"
    [[ -z "$faults" ]] || fail "$name: $faults"
  fi
done
for command in "${commands[@]}"; do
  text="$(page "velamap-$command" | sed 's/\\-/-/g')"
  while read -r option; do
    [[ "$text" == *"--$option\\fR"* ]] || fail "velamap-$command: no --$option"
  done < <(velamap "$command" --help_all | sed -n 's/^  --\([A-Za-z_.]*\) .*/\1/p')
done

# complete WORD...: what bash offers for the last word.
complete_in_bash() {
  bash -c '
    source "$1"; shift
    compopt() { :; }  # outside of a real completion
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _velamap
    echo "${COMPREPLY[*]}"' bash "$share/bash-completion/completions/velamap" "$@"
}
expect_completion() {
  local expected="$1" got
  shift
  got="$(complete_in_bash "$@")"
  [[ "$got" == "$expected" ]] || fail "completion of '$*': expected '$expected', got '$got'"
}
expect_completion "frame_registrator" velamap frame_r
expect_completion "--workspace_path" velamap automatic_reconstructor --works
expect_completion "--help --help_all" velamap shape_comparer --help
expect_completion "thesis" velamap automatic_reconstructor --preset th
expect_completion "colmap markers both" velamap bundle_adjuster --backend ""
expect_completion "0 1" velamap automatic_reconstructor --full_paths = ""
expect_completion "" velamap automatic_reconstructor --Video.first_frame ""
(cd "$share/velamap" && expect_completion "LICENSE" velamap marker_importer --camera_path LIC)
if command -v zsh >/dev/null; then
  zsh -n "$share/zsh/site-functions/_velamap" || fail "zsh does not read its completion"
fi

# The batch script finds the program on the PATH and hands its exit code on.
code=0
(cd "$root" && "$share/velamap/workflows/run_batch.sh" --output_path batch "$root/missing.mp4" -- \
  --camera_path none.yml --layout_path none.yml >"$root/batch.log" 2>&1) || code=$?
[[ $code -eq 2 && -s "$root/batch/summary.csv" ]] || fail "run_batch.sh: exit $code: $(cat "$root/batch.log")"

# The data set's script checks its table wherever Snakemake is.
code=0
"$share/velamap/workflows/dataset/run.sh" "$root/missing.csv" "$root/dataset" 2>"$root/dataset.log" || code=$?
refusal="$(sed -n 's/.*\(missing.csv: No such file\|apt-get install snakemake\).*/\1/p' "$root/dataset.log")"
[[ $code -eq 2 && -n "$refusal" ]] || fail "dataset/run.sh: exit $code: $(cat "$root/dataset.log")"

cmake -DMANIFEST="$manifest" -P "$repository/workflows/install/uninstall.cmake" >/dev/null 2>&1
left="$(find "$prefix" -type f -o -name '*velamap*')"
[[ -z "$left" ]] || fail "left after the uninstallation: $left"

# The version stands in one place; the changes begin with it.
version="$(sed -n 's/^project(velamap VERSION \([0-9.]*\).*/\1/p' "$repository/CMakeLists.txt")"
[[ "$(grep -m 1 '^## ' "$repository/CHANGELOG.md")" == "## $version" ]] ||
  fail "CHANGELOG.md does not begin with the version of CMakeLists.txt, $version"
exit "$status"
