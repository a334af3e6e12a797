#include "importer/camera/storage_check.h"

#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>
#include <opencv2/core.hpp>
#include <pugixml.hpp>

#include "importer/base/csv.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr int kMaxDepth = 16, kMaxValues = 2'000'000;

[[noreturn]] void FailForm(const std::string& path, const std::string& why) {
  throw InputError(
      fmt::format("{}: not a readable OpenCV FileStorage file: {}", path, SingleLine(why)));
}

[[noreturn]] void FailDepth(const std::string& path) {
  FailForm(path, fmt::format("nested more than {} deep", kMaxDepth));
}

// Visits each value as often as aliases repeat it, which OpenCV's parser would, too.
void CheckNode(const YAML::Node& node, int depth, int* num_values, const std::string& path) {
  if (depth > kMaxDepth) FailDepth(path);
  if (++*num_values > kMaxValues) {
    FailForm(path, fmt::format("it holds more than {} values, aliases resolved", kMaxValues));
  }
  for (const auto& child : node) {
    CheckNode(node.IsMap() ? child.second : child, depth + 1, num_values, path);
  }
}

// JSON, too: it is YAML, and OpenCV writes numbers such as 300. that only YAML allows. One document
// is read, because yaml-cpp does not end on some texts of several.
void CheckYaml(const std::string& text, const std::string& path) {
  const std::size_t begin = text.find("\n---"), end = text.find("\n...");
  const bool begins_twice =
      begin != std::string::npos && text.find("\n---", begin + 1) != std::string::npos;
  if (begins_twice ||
      (end != std::string::npos && text.find_first_not_of(" \t\r\n.", end) != std::string::npos)) {
    FailForm(path, "it holds more than one document");
  }
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception& exception) {  // beyond a depth of 500, too
    FailForm(path, exception.what());
  }
  if (!document.IsMap()) FailForm(path, "its top level is not a map of keys");
  int num_values = 0;
  CheckNode(document, 0, &num_values, path);
}

void CheckXml(const std::string& text, const std::string& path) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) FailForm(path, result.description());
  if (std::strcmp(document.document_element().name(), "opencv_storage") != 0) {
    FailForm(path, "its first element is not opencv_storage");
  }
  std::vector<std::pair<pugi::xml_node, int>> nodes = {{document.document_element(), 0}};
  while (!nodes.empty()) {
    const auto [node, depth] = nodes.back();
    nodes.pop_back();
    if (depth > kMaxDepth) FailDepth(path);
    for (const pugi::xml_node child : node) nodes.emplace_back(child, depth + 1);
  }
}

}  // namespace

void CheckStorageText(const std::string& text, const std::string& path) {
  if (text.find('\0') != std::string::npos) FailForm(path, "it holds a zero byte");
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_xml = begin != std::string::npos && text[begin] == '<';
  is_xml ? CheckXml(text, path) : CheckYaml(text, path);
}

cv::FileStorage OpenStorage(const std::string& text, const std::string& path,
                            const std::string& kind) {
  CheckStorageText(text, path);
  std::string reason;
  try {
    cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (storage.isOpened()) {
      storage["any_key"];  // throws where OpenCV takes for text what the checks took for a map
      return storage;
    }
  } catch (const cv::Exception& exception) {
    reason = fmt::format(" ({})", exception.err);
  } catch (const std::length_error&) {  // OpenCV takes a colon at the beginning of a line for a key
    reason = " (a key without a name)";
  }
  throw InputError(fmt::format("{}: not a readable {}{}", path, kind, reason));
}

}  // namespace velamap
