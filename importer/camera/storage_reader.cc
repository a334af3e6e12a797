#include "importer/camera/storage_reader.h"

#include <cstring>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>
#include <opencv2/core.hpp>
#include <pugixml.hpp>

#include "importer/base/error.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

constexpr int kMaxDepth = 16, kMaxValues = 2'000'000;

// The path of a file and what it is, for messages.
struct NamedFile {
  std::string path, kind;
};

[[noreturn]] void FailForm(const NamedFile& file, const std::string& why) {
  throw InputError(fmt::format("{}: not a readable {}: {}", file.path, file.kind, SingleLine(why)));
}

[[noreturn]] void FailDepth(const NamedFile& file) {
  FailForm(file, fmt::format("nested more than {} deep", kMaxDepth));
}

// Whether OpenCV reads the scalar as a number; otherwise it reads a text.
bool IsNumber(const YAML::Node& scalar) {
  constexpr std::size_t kMaxLength = 40;
  static const std::regex pattern(
      R"([-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|Nan|NAN))");
  const std::string& text = scalar.Scalar();
  const bool is_quoted = scalar.Tag() == "!";
  return !is_quoted && text.size() <= kMaxLength && std::regex_match(text, pattern);
}

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + '"';
}

// Writes a YAML document as OpenCV would have written it: block maps, and lists in brackets. Visits
// a value once for each alias that repeats it.
class YamlWriter {
 public:
  explicit YamlWriter(const NamedFile& file) : file_(file) {}

  std::string Write(const YAML::Node& map) {
    text_ = "%YAML:1.0\n---\n";
    WriteMap(map, 0);
    return std::move(text_);
  }

 private:
  void Count(int depth) {
    if (depth > kMaxDepth) FailDepth(file_);
    if (++num_values_ > kMaxValues) {
      FailForm(file_, fmt::format("it holds more than {} values, aliases resolved", kMaxValues));
    }
  }

  void WriteMap(const YAML::Node& map, int depth) {
    static const std::regex name("[A-Za-z_][A-Za-z0-9_-]{0,100}");
    Count(depth);
    for (const auto& child : map) {
      // Skips keys that no caller reads: those with other names, and those without a value.
      const bool is_wanted = child.first.IsScalar() && !child.second.IsNull() &&
                             std::regex_match(child.first.Scalar(), name);
      const std::size_t end = text_.size();
      text_.append(static_cast<std::size_t>(3 * depth), ' ');
      if (is_wanted) text_ += child.first.Scalar() + ": ";
      WriteValue(child.second, depth);
      is_wanted ? text_ += '\n' : text_.erase(end);
    }
  }

  void WriteValue(const YAML::Node& value, int depth) {
    if (value.IsSequence()) {
      WriteList(value, depth + 1);
    } else if (value.IsMap() && value.size() > 0) {
      text_ += '\n';
      WriteMap(value, depth + 1);
    } else {
      Count(depth + 1);
      text_ += value.IsScalar() ? IsNumber(value) ? value.Scalar() : Quoted(value.Scalar()) : "{}";
    }
  }

  void WriteList(const YAML::Node& list, int depth) {
    constexpr int kValuesPerLine = 8;
    Count(depth);
    text_ += "[ ";
    int num_written = 0;
    for (const YAML::Node& value : list) {
      if (num_written > 0) text_ += ", ";
      if (num_written > 0 && num_written % kValuesPerLine == 0) {
        text_ += '\n' + std::string(static_cast<std::size_t>(3 * depth + 3), ' ');
      }
      // Only other programs write lists of maps. Their maps count towards the limit, but are not
      // written.
      const std::size_t end = text_.size();
      WriteValue(value, depth);
      if (!value.IsScalar() && !value.IsSequence()) text_.replace(end, std::string::npos, "\"\"");
      ++num_written;
    }
    text_ += " ]";
  }

  const NamedFile& file_;
  std::string text_;
  int num_values_ = 0;
};

// Reads JSON as YAML, because OpenCV writes numbers such as 300. into JSON, which only YAML allows.
// Reads one document only, because yaml-cpp does not terminate on some texts with several.
std::string RewrittenYaml(const std::string& text, const NamedFile& file) {
  const std::size_t begin = text.find("\n---"), end = text.find("\n...");
  const bool begins_twice =
      begin != std::string::npos && text.find("\n---", begin + 1) != std::string::npos;
  if (begins_twice ||
      (end != std::string::npos && text.find_first_not_of(" \t\r\n.", end) != std::string::npos)) {
    FailForm(file, "it holds more than one document");
  }
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception& exception) {  // also for a depth of more than 500
    FailForm(file, exception.what());
  }
  if (!document.IsMap()) FailForm(file, "its top level is not a map of keys");
  return YamlWriter(file).Write(document);
}

std::string RewrittenXml(const std::string& text, const NamedFile& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) FailForm(file, result.description());
  if (std::strcmp(document.document_element().name(), "opencv_storage") != 0) {
    FailForm(file, "its first element is not opencv_storage");
  }
  std::vector<std::pair<pugi::xml_node, int>> nodes = {{document.document_element(), 0}};
  while (!nodes.empty()) {
    const auto [node, depth] = nodes.back();
    nodes.pop_back();
    if (depth > kMaxDepth) FailDepth(file);
    for (const pugi::xml_node child : node) nodes.emplace_back(child, depth + 1);
  }
  std::ostringstream rewritten;
  document.save(rewritten);
  return rewritten.str();
}

std::string Rewritten(const std::string& text, const NamedFile& file) {
  if (text.find('\0') != std::string::npos) FailForm(file, "it holds a zero byte");
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_xml = begin != std::string::npos && text[begin] == '<';
  return is_xml ? RewrittenXml(text, file) : RewrittenYaml(text, file);
}

}  // namespace

cv::FileStorage OpenStorage(const std::string& text, const std::string& path,
                            const std::string& kind) {
  const std::string rewritten = Rewritten(text, {path, kind});
  try {
    cv::FileStorage storage(rewritten, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (storage.isOpened()) {
      storage["any_key"];  // throws if OpenCV reads text where the checks saw a map
      return storage;
    }
  } catch (const cv::Exception&) {  // its message refers to lines of the rewritten text
  }
  throw InputError(
      fmt::format("{}: not a readable {}; expected keys with values, as OpenCV writes them in "
                  "YAML, XML or JSON",
                  path, kind));
}

}  // namespace velamap
