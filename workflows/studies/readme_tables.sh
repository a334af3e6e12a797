# shellcheck shell=bash
# Functions by which the blocks of the READMEs read the stored results. Sourced by
# update_readmes.sh, which sets `temporary`, a folder, and `place`, the README and line of the
# current block, and defines stored(), which prints the path of a result.

# problem TEXT: records a problem. It is written to a file because blocks are made in subshells.
# shellcheck disable=SC2154
problem() { echo "$*" >>"$temporary/problems"; }

# find_stored RESULT: sets `file` to the path of a result, or records that it is missing.
# shellcheck disable=SC2154
find_stored() {
  file="$(stored "$1")"
  [[ -f "$file" ]] && return
  problem "$place: $file is missing; workflows/studies/update_readmes.sh $1 makes it"
  return 1
}

# data RESULT: prints the rows of a result without the line that names its command.
data() {
  local file
  if find_stored "$1"; then sed 1d "$file"; fi
}

# made_by RESULT: prints the command that made a result, formatted as code.
made_by() { sed -n '1s/^# \(.*\)/`\1`/p' "$(stored "$1")" 2>/dev/null || true; }

# Functions that the awk programs below share. num(x, format) prints x with the number of
# significant digits in the format, but at most four decimals. "+2" also shows the sign, "3%" shows
# a fraction as percent, "d" rounds to an integer, and "as_is" prints what the table holds. An
# unknown value is a dash. span(low, high, format) prints a range such as "0.1 to 0.3".
# shellcheck disable=SC2016
awk_library='
  function num(x, format,    digits, magnitude, exponent, decimals) {
    if (x == "") return "-"
    if (format == "as_is") return x
    if (x == 0) x = 0  # instead of -0
    if (format == "d") return sprintf("%.0f", x)
    if (format ~ /%$/) x *= 100
    digits = format; gsub(/[+%]/, "", digits)
    magnitude = sprintf("%." (digits - 1) "e", x < 0 ? -x : x)
    exponent = magnitude; sub(/.*e/, "", exponent)
    decimals = digits - 1 - exponent
    if (decimals < 0) decimals = 0
    if (decimals > 4) decimals = 4
    return sprintf("%" (format ~ /^[+]/ ? "+" : "") "." decimals "f", x)
  }
  function span(low, high, format,    a, b) {
    a = num(low, format); b = num(high, format)
    return a == b ? a : a " to " b
  }
  function note(n, x) {  # updates the minimum and maximum of the values with the name n
    if (x == "") return
    if (!(n in least) || x + 0 < least[n]) least[n] = x + 0
    if (!(n in most) || x + 0 > most[n]) most[n] = x + 0
  }
  FNR == 1 { next }  # names the command
  FNR == 2 { for (i = 1; i <= NF; i++) column[$i] = i; next }'

# table RESULT AWK_PROGRAM: runs the program on the rows of a result. cell("name") is the value of a
# column.
table() {
  local file
  find_stored "$1" || return 0
  # shellcheck disable=SC2016
  awk -F, "$awk_library"' function cell(name) {
    if (!(name in column)) { print "no column " name > "/dev/stderr"; exit 3 } return $column[name] }
    '"$2" "$file" || problem "$place: $1 has no such rows or columns"
}

# value RESULT COLUMN FORMAT KEY=VALUE...: prints a column of the rows in which the columns KEY have
# the given values, with commas in between.
value() {
  # shellcheck disable=SC2016
  table "$1" '
    { for (k in wanted) if (cell(k) != wanted[k]) next
      row = row separator num(cell("'"$2"'"), "'"$3"'"); separator = ", " }
    BEGIN { n = split("'"${*:4}"'", pairs, " ")
            for (i = 1; i <= n; i++) { split(pairs[i], pair, "="); wanted[pair[1]] = pair[2] } }
    END { if (row == "") exit 3; printf "%s", row }'
}
