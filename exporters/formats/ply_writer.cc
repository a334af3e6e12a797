#include "exporters/formats/ply_writer.h"

#include <cstdint>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "exporters/formats/little_endian.h"
#include "importer/text/csv.h"

namespace velamap::internal {
namespace {

const char* TypeName(PlyType type) {
  switch (type) {
    case PlyType::kUchar:
      return "uchar";
    case PlyType::kInt:
      return "int";
    case PlyType::kFloat:
      return "float";
    case PlyType::kDouble:
      return "double";
  }
  throw std::logic_error("unknown PLY type");
}

void AppendBinary(PlyType type, double value, std::string* body) {
  switch (type) {
    case PlyType::kUchar:
      return body->push_back(static_cast<char>(static_cast<std::uint8_t>(value)));
    case PlyType::kInt:
      return AppendLittleEndian(static_cast<std::int32_t>(value), body);
    case PlyType::kFloat:
      return AppendLittleEndian(static_cast<float>(value), body);
    case PlyType::kDouble:
      return AppendLittleEndian(value, body);
  }
}

void AppendAscii(PlyType type, double value, std::string* body) {
  if (!body->empty() && body->back() != '\n') body->push_back(' ');
  if (type == PlyType::kDouble) {
    fmt::format_to(std::back_inserter(*body), "{}", value);
  } else if (type == PlyType::kFloat) {
    fmt::format_to(std::back_inserter(*body), "{}", static_cast<float>(value));
  } else {
    fmt::format_to(std::back_inserter(*body), "{}", static_cast<std::int32_t>(value));
  }
}

}  // namespace

void WritePlyHead(PlyFormat format, const std::vector<std::string>& comments, std::ostream& out) {
  out << "ply\nformat " << (format == PlyFormat::kAscii ? "ascii" : "binary_little_endian")
      << " 1.0\n";
  for (const std::string& comment : comments) out << "comment " << SingleLine(comment) << '\n';
}

std::string PlyPropertyLine(const std::string& name, PlyType type, bool is_list) {
  return fmt::format("property {}{} {}\n", is_list ? "list uchar " : "", TypeName(type), name);
}

void AppendPlyValue(PlyFormat format, PlyType type, double value, std::string* body) {
  format == PlyFormat::kAscii ? AppendAscii(type, value, body) : AppendBinary(type, value, body);
}

}  // namespace velamap::internal
