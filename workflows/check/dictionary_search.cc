#include "workflows/check/dictionary_search.h"

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

Layout UseDictionary(const DictionaryHint& hint, ArucoDetectionOptions* detection) {
  constexpr double kAnyLength_m = 0.1;
  detection->inverted = hint.inverted;
  return MakeLayout(hint.dictionary, kAnyLength_m);
}

}  // namespace velamap
