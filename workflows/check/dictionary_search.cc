#include "workflows/check/dictionary_search.h"

#include <map>
#include <set>

#include "workflows/proposal/rare_ids.h"

namespace velamap {

std::vector<DictionaryHint> FindDictionaries(const ClipFrames& clip,
                                             const ArucoDetectionOptions& options) {
  std::vector<cv::Mat> images;
  for (const Frame& frame : clip.frames) images.push_back(frame.gray);
  return SuggestDictionaries(images, 1, options);
}

std::string DictionaryName(const DictionaryHint& hint) {
  return hint.dictionary + (hint.inverted ? ", inverted" : "");
}

std::string DictionaryOfIds(const std::vector<DatabaseImage>& images,
                            const std::string& dictionary) {
  const std::map<int, int> num_frames_of_id = CountFramesOfIds(images);
  const std::set<int> rare = FindRareIds(num_frames_of_id);
  int max_id = 0;
  for (const auto& [marker_id, num_frames] : num_frames_of_id) {
    if (rare.count(marker_id) == 0) max_id = marker_id;
  }
  return SmallestOfFamily(dictionary, max_id);
}

Layout UseDictionary(const DictionaryHint& hint, ArucoDetectionOptions* detection) {
  constexpr double kAnyLength_m = 0.1;
  detection->inverted = hint.inverted;
  return MakeLayout(hint.dictionary, kAnyLength_m);
}

}  // namespace velamap
