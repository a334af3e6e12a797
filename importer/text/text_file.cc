#include "importer/text/text_file.h"

#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {

void CheckInputFile(const std::string& path, const std::string& what, std::uintmax_t max_size) {
  if (!Exists(path)) return;
  if (!IsRegularFile(path)) {
    throw InputError(fmt::format("{}: the {} is not a regular file", path, what));
  }
  if (FileSize(path) > max_size) {
    throw InputError(fmt::format(
        "{}: {} bytes are too many for a {}, which has at most {}; check that it is the right file",
        path, FileSize(path), what, max_size));
  }
}

std::string ReadTextFile(const std::string& path, const std::string& what) {
  if (path.empty() || !Exists(path)) {
    throw InputError(fmt::format("{}: there is no such {}", path.empty() ? "''" : path, what));
  }
  CheckInputFile(path, what, kMaxTextFileSize);
  std::ifstream stream(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream) throw InputError(fmt::format("{}: the {} cannot be read", path, what));
  if (text.rfind(kByteOrderMark, 0) == 0) text.erase(0, kByteOrderMark.size());
  if (text.rfind(kByteOrderMark, 0) == 0) {
    throw InputError(fmt::format(
        "{}: the {} begins with two byte order marks; save it as UTF-8 without any", path, what));
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(fmt::format("{}: the {} is empty", path, what));
  }
  return text;
}

void CheckUtf8(const std::string& text, const std::string& path) {
  std::istringstream stream(text);
  int number = 1;
  for (std::string line; std::getline(stream, line); ++number) {
    try {
      nlohmann::json(line).dump();
    } catch (const nlohmann::json::type_error&) {
      throw InputError(fmt::format("{}:{}: not UTF-8; save the file as UTF-8", path, number));
    }
  }
}

}  // namespace velamap
