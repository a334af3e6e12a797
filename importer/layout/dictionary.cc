#include "importer/layout/dictionary.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/ids.h"
#include "importer/base/log.h"
#include "importer/camera/storage_reader.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

using PredefinedEntry = std::pair<const char*, cv::aruco::PREDEFINED_DICTIONARY_NAME>;

constexpr char kThesisName[] = "THESIS_3X3_130";

constexpr std::array<PredefinedEntry, 21> kPredefined = {{
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
    {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
    {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
    {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
    {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
    {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
    {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
    {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
    {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
    {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
    {"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
    {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11},
}};

std::string ToLower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

const PredefinedEntry* FindPredefined(const std::string& name) {
  const std::string lower = ToLower(name);
  for (const PredefinedEntry& entry : kPredefined) {
    const std::string known = ToLower(entry.first);
    if (lower == known || "dict_" + lower == known) return &entry;
  }
  return nullptr;
}

[[noreturn]] void Fail(const std::string& path, const std::string& key,
                       const std::string& message) {
  throw InputError(fmt::format("{}: key '{}': {}", path, key, message));
}

std::optional<int> ReadInt(const cv::FileStorage& storage, const std::string& path,
                           const std::string& key, int min, int max) {
  const cv::FileNode node = storage[key];
  if (node.empty()) return std::nullopt;
  const int value = node.isInt() ? static_cast<int>(node) : min - 1;
  if (value < min || value > max) {
    Fail(path, key, fmt::format("a whole number from {} to {} is expected", min, max));
  }
  return value;
}

int RequireInt(const cv::FileStorage& storage, const std::string& path, const std::string& key,
               int min, int max) {
  const std::optional<int> value = ReadInt(storage, path, key, min, max);
  if (!value) {
    Fail(path, key,
         "missing; a cv::aruco dictionary file has nmarkers, markersize and marker_0, marker_1 "
         "...");
  }
  return *value;
}

cv::Mat ReadMarkerBits(const cv::FileStorage& storage, const std::string& path,
                       const std::string& key, int marker_size) {
  const cv::FileNode node = storage[key];
  if (node.empty()) Fail(path, key, "missing, although nmarkers says that it is there");
  if (!node.isString()) {
    Fail(path, key, "the bits must be a string; put them in quotes");
  }
  const std::string text = node.string();
  if (text.size() != static_cast<std::size_t>(marker_size * marker_size)) {
    Fail(path, key,
         fmt::format("{}x{} bits are expected, found {} characters", marker_size, marker_size,
                     text.size()));
  }
  cv::Mat bits(marker_size, marker_size, CV_8UC1);
  for (int i = 0; i < marker_size * marker_size; ++i) {
    const char bit = text[static_cast<std::size_t>(i)];
    if (bit != '0' && bit != '1') {
      Fail(path, key, fmt::format("bits are 0 and 1, found '{}'", bit));
    }
    bits.at<std::uint8_t>(i / marker_size, i % marker_size) = bit == '1';
  }
  return bits;
}

// The smallest number of bits in which two markers differ, over all rotations. Throws InputError if
// two markers are the same.
int MinDistance(const std::vector<cv::Mat>& bits, const std::string& path) {
  int min_distance = static_cast<int>(bits.front().total()) + 1;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    cv::Mat turned = bits[i].clone();
    for (int turns = 0; turns < 4; ++turns) {
      for (std::size_t j = i + 1; j < bits.size(); ++j) {
        const int distance = static_cast<int>(cv::norm(turned, bits[j], cv::NORM_L1) + 0.5);
        if (distance == 0) {
          Fail(path, fmt::format("marker_{}", j),
               fmt::format("the same as marker_{} turned by {} degrees", i, 90 * turns));
        }
        min_distance = std::min(min_distance, distance);
      }
      cv::rotate(turned, turned, cv::ROTATE_90_CLOCKWISE);
    }
  }
  return min_distance;
}

Dictionary ReadDictionaryFile(const std::string& path) {
  const std::string text = ReadTextFile(path, "dictionary file");
  CheckUtf8(text, path);
  const cv::FileStorage storage = OpenStorage(text, path, "cv::aruco dictionary file");
  const int num_markers = RequireInt(storage, path, "nmarkers", 1, kMaxMarkerId + 1);
  const int marker_size = RequireInt(storage, path, "markersize", 3, 20);
  const int max_bits = marker_size * marker_size;
  int correction_bits = ReadInt(storage, path, "maxCorrectionBits", 0, max_bits).value_or(0);
  std::vector<cv::Mat> bits;
  cv::Mat bytes;
  for (int id = 0; id < num_markers; ++id) {
    bits.push_back(ReadMarkerBits(storage, path, fmt::format("marker_{}", id), marker_size));
    bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits.back()));
  }
  const int unique_bits = (MinDistance(bits, path) - 1) / 2;
  if (correction_bits > unique_bits) {
    LogWarning("{}: maxCorrectionBits {} would confuse markers; using {}", path, correction_bits,
               unique_bits);
    correction_bits = unique_bits;
  }
  return {std::filesystem::path(path).filename().string(),
          cv::makePtr<cv::aruco::Dictionary>(bytes, marker_size, correction_bits)};
}

}  // namespace

Dictionary LoadDictionary(const std::string& name_or_path) {
  if (const PredefinedEntry* entry = FindPredefined(name_or_path)) {
    return {entry->first, cv::aruco::getPredefinedDictionary(entry->second)};
  }
  if (ToLower(name_or_path) == ToLower(kThesisName)) {
    return MakeDictionary(kThesisName, ThesisCodes());
  }
  if (name_or_path.empty() || !Exists(name_or_path)) {
    throw InputError(fmt::format("dictionary '{}': neither a file nor one of {}", name_or_path,
                                 fmt::join(PredefinedDictionaryNames(), " ")));
  }
  return ReadDictionaryFile(name_or_path);
}

std::vector<std::string> PredefinedDictionaryNames() {
  std::vector<std::string> names;
  for (const PredefinedEntry& entry : kPredefined) names.push_back(entry.first);
  names.push_back(kThesisName);
  return names;
}

bool IsOpenCvName(const std::string& name) { return FindPredefined(name) != nullptr; }

int NumMarkers(const Dictionary& dictionary) { return dictionary.aruco->bytesList.rows; }

int CellsPerSide(const Dictionary& dictionary, int border_bits) {
  return dictionary.aruco->markerSize + 2 * border_bits;
}

Dictionary MakeDictionary(const std::string& name, const CodeSet& codes) {
  cv::Mat bytes;
  for (const MarkerCode code : codes.codes) {
    cv::Mat bits(codes.bits_per_side, codes.bits_per_side, CV_8UC1);
    for (int i = 0; i < static_cast<int>(bits.total()); ++i) {
      bits.at<std::uint8_t>(i / bits.cols, i % bits.cols) = code >> i & 1;
    }
    bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits));
  }
  const int correction_bits = std::max(0, (codes.min_distance - 1) / 2);
  return {name, cv::makePtr<cv::aruco::Dictionary>(bytes, codes.bits_per_side, correction_bits)};
}

cv::Mat MarkerBits(const Dictionary& dictionary, int marker_id) {
  return cv::aruco::Dictionary::getBitsFromByteList(dictionary.aruco->bytesList.row(marker_id),
                                                    dictionary.aruco->markerSize);
}

std::string DictionaryText(const Dictionary& dictionary) {
  const cv::aruco::Dictionary& aruco = *dictionary.aruco;
  std::string text =
      fmt::format("%YAML:1.0\n---\nnmarkers: {}\nmarkersize: {}\nmaxCorrectionBits: {}\n",
                  NumMarkers(dictionary), aruco.markerSize, aruco.maxCorrectionBits);
  for (int id = 0; id < NumMarkers(dictionary); ++id) {
    text += fmt::format("marker_{}: \"", id);
    for (const std::uint8_t bit : cv::Mat_<std::uint8_t>(MarkerBits(dictionary, id))) {
      text += bit != 0 ? '1' : '0';
    }
    text += "\"\n";
  }
  return text;
}

cv::Mat MarkerCells(const Dictionary& dictionary, int marker_id, int border_bits) {
  cv::Mat cells;
  cv::aruco::drawMarker(dictionary.aruco, marker_id, CellsPerSide(dictionary, border_bits), cells,
                        border_bits);
  return cells;
}

std::optional<ReadCode> ReadCells(const Dictionary& dictionary, const cv::Mat& cells,
                                  int border_bits) {
  const int size = dictionary.aruco->markerSize;
  VELAMAP_CHECK(cells.rows == cells.cols && cells.rows == CellsPerSide(dictionary, border_bits));
  const cv::Rect inner(border_bits, border_bits, size, size);
  if (cv::countNonZero(cells) != cv::countNonZero(cells(inner))) return std::nullopt;
  ReadCode code;
  int num_turns = 0;
  if (!dictionary.aruco->identify(cells(inner) / 255, code.marker_id, num_turns, 0.0)) {
    return std::nullopt;
  }
  code.first_corner = (kNumCorners - num_turns) % kNumCorners;
  return code;
}

}  // namespace velamap
