#include "importer/text/csv.h"

#include <algorithm>
#include <istream>
#include <ostream>

#include "importer/base/error.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

// Parses one line after another until the record is complete.
class RecordParser {
 public:
  RecordParser(const std::string& name, int line) : name_(name) { record_.line = line; }

  // Returns whether the record ends with this line. It does not if quotes are still open.
  bool ParseLine(const std::string& text) {
    if (text.find('\0') != std::string::npos) {
      throw InputError(name_ + ":" + std::to_string(record_.line) +
                       ": a zero byte, which no CSV holds; save the table as CSV in UTF-8");
    }
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (inside_quotes_) {
        if (text[i] != '"') {
          field_ += text[i];
        } else if (i + 1 < text.size() && text[i + 1] == '"') {
          field_ += text[++i];
        } else {
          inside_quotes_ = false;
          closed_quotes_ = true;
        }
      } else if (text[i] == '\r' && i + 1 == text.size()) {
        continue;
      } else if (text[i] == ',') {
        EndField();
      } else if (text[i] == '"' && field_.empty() && !closed_quotes_) {
        inside_quotes_ = true;
      } else if (closed_quotes_) {
        throw InputError(name_ + ":" + std::to_string(record_.line) +
                         ": text follows a closing quote, expected a comma");
      } else {
        field_ += text[i];
      }
    }
    if (inside_quotes_) {
      field_ += '\n';
      return false;
    }
    EndField();
    return true;
  }

  CsvRecord TakeRecord() { return std::move(record_); }

 private:
  void EndField() {
    record_.fields.push_back(std::move(field_));
    field_.clear();
    closed_quotes_ = false;
  }

  const std::string& name_;
  CsvRecord record_;
  std::string field_;
  bool inside_quotes_ = false;
  bool closed_quotes_ = false;
};

// Reads the next line without its line feed. Returns false at the end.
bool GetLine(std::istream& in, int* line, std::string* text) {
  if (!std::getline(in, *text)) return false;
  ++*line;
  if (*line == 1 && text->rfind(kByteOrderMark, 0) == 0) text->erase(0, kByteOrderMark.size());
  return true;
}

}  // namespace

std::vector<CsvRecord> ReadCsv(std::istream& in, const std::string& name) {
  std::vector<CsvRecord> records;
  std::string text;
  int line = 0;
  while (GetLine(in, &line, &text)) {
    if (text.empty() || text == "\r" || text.front() == '#') continue;
    RecordParser parser(name, line);
    const int first_line = line;
    while (!parser.ParseLine(text)) {
      if (!GetLine(in, &line, &text)) {
        throw InputError(name + ":" + std::to_string(first_line) +
                         ": a quote is opened and never closed");
      }
    }
    records.push_back(parser.TakeRecord());
  }
  if (in.bad()) throw InputError(name + ": cannot be read; check that it is a file");
  return records;
}

std::string SingleLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

std::string CsvField(const std::string& text) {
  // A leading # would be read as a comment if the field came first.
  if (text.find_first_of(",\"\r\n") == std::string::npos && text.rfind('#', 0) != 0) return text;
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

void CsvWriter::Append(std::string_view field) {
  if (num_fields_++ > 0) record_ += ',';
  record_ += field;
}

void CsvWriter::EndRecord() {
  // An empty line would not be read as a record.
  out_ << (record_.empty() && num_fields_ == 1 ? "\"\"" : record_) << '\n';
  num_fields_ = 0;
  record_.clear();
}

}  // namespace velamap
