// When no marker is found: which dictionary and polarity would have found some.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/detection_options.h"

namespace velamap {

struct DictionaryHint {
  std::string dictionary;  // the smallest of its family that has all ids found
  bool inverted = false;
  int num_markers = 0;  // found in the images that were looked at
  int num_images = 0;   // that were looked at
};

// Tries all predefined dictionaries, without error correction, in both polarities. Those with at
// least two detections, most first, at most three. Ends early once one explains many.
std::vector<DictionaryHint> SuggestDictionaries(const std::vector<cv::Mat>& gray_images,
                                                int border_bits,
                                                const ArucoDetectionOptions& options);

// "--dictionary DICT_4X4_50 --ArucoDetection.inverted 1 (20 markers in 3 images), or ...".
std::string DescribeHints(const std::vector<DictionaryHint>& hints);

// Grey images spread evenly over a stream of unknown length, at most twelve.
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
