// Suggests the dictionary and polarity that would have found markers where none were found.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/detection_options.h"

namespace velamap {

struct DictionaryHint {
  std::string dictionary;  // the smallest of its family that contains nearly all detected ids
  bool inverted = false;
  int num_markers = 0;  // of these ids, detected in the images
  int num_images = 0;   // searched with all dictionaries
};

// Tries all predefined dictionaries in both polarities, without error correction. Returns at most
// three, by descending number of detections: those with two or more detections, and at least one in
// two images, that are unlikely to be chance. Once a dictionary has detected many markers, only its
// family is searched for in the remaining images, for their ids.
std::vector<DictionaryHint> SuggestDictionaries(const std::vector<cv::Mat>& gray_images,
                                                int border_bits,
                                                const ArucoDetectionOptions& options);

// The predefined dictionaries of a family, such as DICT_4X4_50 to DICT_4X4_1000, begin with the
// same markers. These return the smallest one that has the id, and the largest one, in the family
// of `dictionary`; this is `dictionary` itself if its family has only one.
std::string SmallestOfFamily(const std::string& dictionary, int max_id);
std::string LargestOfFamily(const std::string& dictionary);

// "--dictionary DICT_4X4_50 --ArucoDetection.inverted 1 (20 markers in 3 images), or ...", and what
// to do with a layout file.
std::string DescribeHints(const std::vector<DictionaryHint>& hints);

// Keeps at most twelve grey images, spread evenly over a stream of unknown length.
class ImageSample {
 public:
  void Add(int idx, const cv::Mat& gray);
  void Clear() { images_.clear(); }
  std::vector<cv::Mat> Images() const;

 private:
  bool Wants(int idx) const { return idx % stride_ == 0; }

  int stride_ = 1;
  std::vector<std::pair<int, cv::Mat>> images_;
};

}  // namespace velamap
