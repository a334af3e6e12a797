// Comma-separated values after RFC 4180: fields with a comma, a quote or a line break are quoted,
// and a quote inside such a field is doubled.

#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

namespace velamap {

struct CsvRecord {
  int line = 0;  // of the file, from 1; where the record starts
  std::vector<std::string> fields;
};

// Reads all records. Skips empty lines, lines that start with #, a byte order mark and the carriage
// return at the end of a line. Throws InputError that names `name` and the line.
std::vector<CsvRecord> ReadCsv(std::istream& in, const std::string& name);

// Replaces control characters by spaces. Names come from the layout or the file system and may hold
// line breaks, which would end a line of a header or of a table.
std::string SingleLine(std::string text);

// Returns the text as a field, quoted where necessary.
std::string CsvField(const std::string& text);

// Writes records that ReadCsv reads back as they were:
//
//   CsvWriter csv(out);
//   csv.WriteRecord("image_name", "num_markers", "error_m");
//   csv.WriteRecord(image_name, 12, std::optional<double>());
class CsvWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  template <typename... Fields>
  void WriteRecord(const Fields&... fields) {
    (AddField(fields), ...);
    EndRecord();
  }

  // For records whose fields are known at run time only. Text is quoted where necessary, a number
  // takes the fewest digits that read back to the same value, a bool is 0 or 1, and an empty
  // optional is an empty field.
  template <typename Field>
  void AddField(const Field& field) {
    if constexpr (std::is_same_v<Field, bool>) {
      Append(field ? "1" : "0");
    } else if constexpr (std::is_arithmetic_v<Field>) {
      Append(fmt::format("{}", field));
    } else {
      Append(CsvField(std::string(field)));
    }
  }
  template <typename Field>
  void AddField(const std::optional<Field>& field) {
    field ? AddField(*field) : Append("");
  }
  // Every element becomes a field.
  template <typename Range>
  void AddFields(const Range& fields) {
    for (const auto& field : fields) AddField(field);
  }
  void EndRecord();

 private:
  void Append(std::string_view field);

  std::ostream& out_;
  int num_fields_ = 0;
  std::string record_;
};

}  // namespace velamap
