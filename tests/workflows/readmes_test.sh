#!/usr/bin/env bash
# Checks the numbers in the READMEs, that the check can fail, and that files which READMEs name exist.
# usage: readmes_test.sh REPOSITORY
set -euo pipefail

repository="$1"
copy="$(mktemp -d)"
trap 'rm -rf "$copy"' EXIT
status=0

fail() {
  echo "$*"
  status=1
}

# run MODE: runs update_readmes.sh in the copy; sets output and code.
run() { output="$("$copy/workflows/studies/update_readmes.sh" "$@" 2>&1)" && code=0 || code=$?; }

# expect CODE TEXT WHAT: of the last run.
expect() {
  if [[ $code -ne $1 || "$output" != *"$2"* ]]; then
    fail "$3: expected exit $1 and '$2', got exit $code and: $output"
  fi
}

"$repository/workflows/studies/update_readmes.sh" --check || fail "the READMEs are out of date"

# A copy with two of the READMEs, to be damaged.
(cd "$repository" && tar -cf - README.md sample_project/README.md workflows/studies \
  tests/benchmarks/{readme_blocks.sh,results}) | tar -xf - -C "$copy"
rm "$copy/workflows/studies/README.md"
run --check
expect 0 "" "an unchanged copy"

readme="$copy/README.md"
cp "$readme" "$copy/saved"
line="$(grep -n '^images: ' "$readme" | cut -d: -f1)"
sed -i "${line}s/.*/images: 99 of 99 used/" "$readme"
run --check
expect 1 "README.md:$line: block sample_output" "a changed number"
grep -q 'images: 99 of 99 used' "$readme" || fail "--check has changed a README"
run --write
cmp -s "$readme" "$copy/saved" || fail "--write does not bring back the stored number"

printf '<!-- numbers: no_such_block -->\n<!-- end -->\n' >>"$readme"
run --check
expect 1 "no_such_block" "an unknown block"
cp "$copy/saved" "$readme"
echo '<!-- numbers: cube -->' >>"$readme"
run --check
expect 1 "block cube has no <!-- end -->" "a block without an end"
run --write
expect 1 "block cube has no <!-- end -->" "writing a block without an end"
cp "$copy/saved" "$readme"

results="$copy/workflows/studies/results"
mkdir "$copy/work"
sed 1d "$results/sample_project.csv" >"$copy/work/sample_project.csv"
sed '1d; s/^images: .*/images: 98 of 98 used/' "$results/sample_project.txt" >"$copy/work/sample_project.txt"
cp "$results/sample_project.txt" "$copy/saved.txt"
run --collect sample_project.csv "$copy/work"
grep -q 'images: 98 of 98 used' "$readme" || fail "--collect has parted the results of one run: $output"
mv "$copy/saved.txt" "$results/sample_project.txt"
cp "$copy/saved" "$readme"

mv "$results/accuracy.csv" "$copy/accuracy.csv"
run --check
expect 1 "accuracy.csv is missing" "a missing result"
sed 's/^clip,way/clip,method/' "$copy/accuracy.csv" >"$results/accuracy.csv"
run --check
expect 1 "accuracy.csv has no such rows or columns" "a result without a column"

# Files in code spans: `importer/text/csv.h` from the root or the README's folder, `csv.h` below it.
cd "$repository"
while IFS=: read -r readme path; do
  folder="$(dirname "$readme")"
  if [[ "$path" == */* ]]; then
    [[ -e "$path" || -e "$folder/$path" ]] || fail "$readme names $path, which does not exist"
  else
    [[ -n "$(find "$folder" -name "$path" -not -path './build/*' -print -quit)" ]] ||
      fail "$readme names $path, which is not below its folder"
  fi
done < <(find . -name '*.md' -not -path './build/*' -not -path './workspace/*' -not -path './.*/*' \
  -exec grep -Ho '`[a-z0-9_./]*\.\(h\|cc\|sh\|cmake\|awk\)`' {} + | tr -d '`')
exit "$status"
