// Comma-separated values as RFC 4180 has them: fields with a comma, a quote or a line break are
// quoted, a quote inside is doubled.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace velamap {

struct CsvRecord {
  int line = 0;  // of the file, from 1; where the record starts
  std::vector<std::string> fields;
};

// Reads all records. Empty lines, lines that start with #, a byte order mark and carriage returns
// before a line's end are passed over. Throws InputError that names `name` and the line.
std::vector<CsvRecord> ReadCsv(std::istream& in, const std::string& name);

// Control characters become spaces: names come from the layout and may hold line breaks, a comment
// or a header must not.
std::string SingleLine(std::string text);

// The text as a field, quoted where it has to be.
std::string CsvField(const std::string& text);

}  // namespace velamap
