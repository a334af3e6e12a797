#include "importer/dictionary_hint.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "importer/base/log.h"
#include "importer/detect/marker_search.h"

namespace velamap {
namespace {

constexpr int kMaxNumSamples = 12;
// Over many pictures, chance finds a few markers of any dictionary.
constexpr int kMinNumMarkers = 2;
constexpr double kMinMarkersPerImage = 0.5;
// The largest share of detections that may be false, with ids beyond a smaller dictionary of the
// family.
constexpr double kMaxShareBeyond = 0.05;
constexpr int kConvincingNumMarkers = 20;
constexpr std::size_t kMaxNumHints = 3;
constexpr std::chrono::seconds kTalkInterval{1};
constexpr double kMaxChance = 0.01;  // that the ids of false markers are all among the first

// The largest dictionaries. The smaller ones of a family are the first markers of the largest.
constexpr std::array<const char*, 9> kFamilies = {
    "DICT_4X4_1000",      "DICT_5X5_1000",       "DICT_6X6_1000",
    "DICT_7X7_1000",      "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5",
    "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10", "DICT_APRILTAG_36h11"};

// The size of the smallest dictionary of the family that has the id; 0 if the family has only one.
int SizeWithId(const std::string& family, int max_id) {
  const std::string largest = "_1000";
  if (family.compare(family.size() - largest.size(), largest.size(), largest) != 0) return 0;
  for (const int size : {50, 100, 250}) {
    if (max_id < size) return size;
  }
  return 1000;
}

struct Found {
  std::map<int, int> num_of_id;

  int NumUpTo(int max_id) const {
    int num = 0;
    for (const auto& [id, num_markers] : num_of_id) num += id <= max_id ? num_markers : 0;
    return num;
  }
  int NumMarkers() const { return NumUpTo(std::numeric_limits<int>::max()); }

  // The largest id, not counting a few that are far beyond all others, because prints number their
  // markers without large gaps; -1 if there are none.
  int MaxId() const {
    constexpr double kGapFactor = 1.5;
    constexpr int kLeastGap = 10;
    const double least = (1 - kMaxShareBeyond) * NumMarkers();
    for (auto it = num_of_id.begin(); it != num_of_id.end(); ++it) {
      const auto next = std::next(it);
      if (next == num_of_id.end()) return it->first;
      const bool is_gap = next->first > kGapFactor * it->first + kLeastGap;
      if (is_gap && NumUpTo(it->first) >= least) return it->first;
    }
    return -1;
  }
  int NumIdsUpTo(int max_id) const {
    return static_cast<int>(std::distance(num_of_id.begin(), num_of_id.upper_bound(max_id)));
  }
};

// Every sixteenth pattern of 4x4 bits, in one of its rotations, is a code of DICT_4X4_1000, so
// pictures of anything contain some. Chance spreads their ids over the whole dictionary and seldom
// repeats one. Other families have too few codes for their bits to be hit by chance.
bool MayBeChance(const std::string& family, const Found& found) {
  if (family != "DICT_4X4_1000") return false;
  const int max_id = found.MaxId(), num_ids = found.NumIdsUpTo(max_id);
  const double share = SizeWithId(family, max_id) / 1000.0;
  const bool are_first_ids = std::pow(share, num_ids) < kMaxChance;
  return !are_first_ids && found.NumUpTo(max_id) < 2 * num_ids;
}

using Choice = std::pair<std::string, bool>;  // family, inverted

void CountMarkers(const cv::Mat& gray, const Choice& choice, int border_bits,
                  ArucoDetectionOptions options, Found* found) {
  options.error_correction_rate = 0.0;
  options.inverted = choice.second;
  const Dictionary dictionary = LoadDictionary(choice.first);
  for (const MarkerQuad& marker :
       SearchMarkersAtFirstLook(gray, dictionary, border_bits, options)) {
    ++found->num_of_id[marker.marker_id];
  }
}

// The choices that are unlikely to be chance, by descending number of markers.
std::vector<std::pair<Choice, Found>> LikelyChoices(const std::map<Choice, Found>& found_by_choice,
                                                    int num_images) {
  const double least = std::max<double>(kMinNumMarkers, kMinMarkersPerImage * num_images);
  std::vector<std::pair<Choice, Found>> likely;
  for (const auto& [choice, found] : found_by_choice) {
    if (found.NumUpTo(found.MaxId()) < least || MayBeChance(choice.first, found)) continue;
    likely.emplace_back(choice, found);
  }
  std::stable_sort(likely.begin(), likely.end(), [](const auto& a, const auto& b) {
    return a.second.NumUpTo(a.second.MaxId()) > b.second.NumUpTo(b.second.MaxId());
  });
  if (likely.size() > kMaxNumHints) likely.resize(kMaxNumHints);
  return likely;
}

}  // namespace

std::string SmallestOfFamily(const std::string& dictionary, int max_id) {
  const std::string family = LargestOfFamily(dictionary);
  const int size = SizeWithId(family, max_id);
  return size == 0 ? family : family.substr(0, family.rfind('_') + 1) + std::to_string(size);
}

std::string LargestOfFamily(const std::string& dictionary) {
  const std::string largest = dictionary.substr(0, dictionary.rfind('_') + 1) + "1000";
  const bool has_sizes = std::find(kFamilies.begin(), kFamilies.end(), largest) != kFamilies.end();
  return has_sizes ? largest : dictionary;
}

std::vector<DictionaryHint> SuggestDictionaries(const std::vector<cv::Mat>& gray_images,
                                                int border_bits,
                                                const ArucoDetectionOptions& options) {
  std::map<Choice, Found> found_by_choice;
  bool convinced = false;
  std::size_t num_images = 0;
  auto last_said = std::chrono::steady_clock::now();
  for (; num_images < gray_images.size() && !convinced; ++num_images) {
    if (std::chrono::steady_clock::now() - last_said > kTalkInterval) {
      last_said = std::chrono::steady_clock::now();
      LogInfo("trying all dictionaries: picture {} of {}", num_images + 1, gray_images.size());
    }
    for (const char* family : kFamilies) {
      for (const bool inverted : {false, true}) {
        Found& found = found_by_choice[{family, inverted}];
        CountMarkers(gray_images[num_images], {family, inverted}, border_bits, options, &found);
        convinced |= found.NumMarkers() >= kConvincingNumMarkers && !MayBeChance(family, found);
      }
    }
  }
  std::vector<DictionaryHint> hints;
  for (auto& [choice, found] : LikelyChoices(found_by_choice, static_cast<int>(num_images))) {
    const int num_markers = found.NumUpTo(found.MaxId());
    // One picture may show few of the ids; the size of the dictionary follows from all of them.
    for (std::size_t i = num_images; hints.empty() && i < gray_images.size(); ++i) {
      CountMarkers(gray_images[i], choice, border_bits, options, &found);
    }
    hints.push_back({SmallestOfFamily(choice.first, found.MaxId()), choice.second, num_markers,
                     static_cast<int>(num_images)});
  }
  return hints;
}

std::string DescribeHints(const std::vector<DictionaryHint>& hints) {
  std::string text;
  for (const DictionaryHint& hint : hints) {
    if (!text.empty()) text += ", or ";
    text += fmt::format("--dictionary {} --ArucoDetection.inverted {} ({} markers in {} images)",
                        hint.dictionary, hint.inverted ? 1 : 0, hint.num_markers, hint.num_images);
  }
  return text.empty() ? text : text + "; with a layout file, change its key `dictionary`";
}

void ImageSample::Add(int idx, const cv::Mat& gray) {
  if (!Wants(idx)) return;
  images_.emplace_back(idx, gray);
  while (images_.size() > kMaxNumSamples) {
    stride_ *= 2;
    images_.erase(std::remove_if(images_.begin(), images_.end(),
                                 [&](const auto& image) { return !Wants(image.first); }),
                  images_.end());
  }
}

std::vector<cv::Mat> ImageSample::Images() const {
  std::vector<cv::Mat> images;
  for (const auto& [idx, gray] : images_) images.push_back(gray);
  return images;
}

}  // namespace velamap
