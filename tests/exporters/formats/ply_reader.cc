#include "tests/exporters/formats/ply_reader.h"

#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace velamap {
namespace {

template <typename T>
double TakeBinary(const std::string& bytes, std::size_t* position) {
  T value;
  if (*position + sizeof value > bytes.size()) throw std::runtime_error("PLY body too short");
  std::memcpy(&value, bytes.data() + *position, sizeof value);  // tests run on little-endian
  *position += sizeof value;
  return static_cast<double>(value);
}

double TakeBinary(const std::string& type, const std::string& bytes, std::size_t* position) {
  if (type == "uchar") return TakeBinary<std::uint8_t>(bytes, position);
  if (type == "int") return TakeBinary<std::int32_t>(bytes, position);
  if (type == "float") return TakeBinary<float>(bytes, position);
  if (type == "double") return TakeBinary<double>(bytes, position);
  throw std::runtime_error("PLY type " + type);
}

double TakeAscii(const std::string& bytes, std::size_t* position) {
  const std::size_t end = bytes.find_first_of(" \n", *position);
  if (end == std::string::npos || end == *position) throw std::runtime_error("PLY body: no number");
  std::size_t used = 0;
  const std::string text = bytes.substr(*position, end - *position);
  const double value = std::stod(text, &used);
  if (used != text.size()) throw std::runtime_error("PLY body: not a number: " + text);
  *position = end + 1;
  return value;
}

PlyFile ReadHeader(const std::string& header, std::vector<std::size_t>* num_rows) {
  PlyFile file;
  std::istringstream lines(header);
  std::string line;
  if (!std::getline(lines, line) || line != "ply") throw std::runtime_error("not a PLY file");
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string keyword, text;
    words >> keyword;
    if (keyword == "format") {
      words >> file.format;
    } else if (keyword == "element") {
      file.elements.emplace_back();
      num_rows->emplace_back();
      words >> file.elements.back().name >> num_rows->back();
    } else if (keyword == "property") {
      PlyReadProperty property;
      words >> property.type;
      if (property.type == "list") words >> property.list_count_type >> property.type;
      words >> property.name;
      file.elements.back().properties.push_back(property);
    } else if (keyword != "comment") {
      throw std::runtime_error("PLY header: " + line);
    }
    if (!words) throw std::runtime_error("PLY header: " + line);
  }
  return file;
}

std::size_t IndexOf(const PlyReadElement& element, const std::string& property, bool is_list) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].name == property &&
        element.properties[i].list_count_type.empty() != is_list) {
      return i;
    }
  }
  throw std::runtime_error("no PLY property " + property);
}

}  // namespace

std::vector<double> PlyReadElement::Column(const std::string& property) const {
  const std::size_t index = IndexOf(*this, property, false);
  std::vector<double> column;
  for (const auto& row : rows) column.push_back(row[index].at(0));
  return column;
}

std::vector<std::vector<double>> PlyReadElement::ListColumn(const std::string& property) const {
  const std::size_t index = IndexOf(*this, property, true);
  std::vector<std::vector<double>> column;
  for (const auto& row : rows) column.push_back(row[index]);
  return column;
}

PlyFile ReadPly(const std::string& bytes) {
  const std::string kEnd = "\nend_header\n";
  const std::size_t end = bytes.find(kEnd);
  if (end == std::string::npos) throw std::runtime_error("PLY header has no end");
  std::vector<std::size_t> num_rows;
  PlyFile file = ReadHeader(bytes.substr(0, end), &num_rows);
  const bool is_ascii = file.format == "ascii";
  if (!is_ascii && file.format != "binary_little_endian") throw std::runtime_error("PLY format");

  std::size_t position = end + kEnd.size();
  const auto take = [&](const std::string& type) {
    return is_ascii ? TakeAscii(bytes, &position) : TakeBinary(type, bytes, &position);
  };
  for (std::size_t e = 0; e < file.elements.size(); ++e) {
    PlyReadElement& element = file.elements[e];
    element.rows.resize(num_rows[e]);
    for (auto& row : element.rows) {
      for (const PlyReadProperty& property : element.properties) {
        std::vector<double> values(
            property.list_count_type.empty() ? 1 : take(property.list_count_type));
        for (double& value : values) value = take(property.type);
        row.push_back(values);
      }
      if (is_ascii && bytes[position - 1] != '\n') throw std::runtime_error("PLY row too long");
    }
  }
  if (position != bytes.size()) throw std::runtime_error("PLY body too long");
  return file;
}

}  // namespace velamap
