// Options of detection. They are free of OpenCV, so that every room can include them.

#pragma once

#include <string>

#include "importer/base/option.h"

namespace velamap {

enum class CornerRefinement {
  kNone,    // corners of the detector's polygon
  kSubpix,  // cv::cornerSubPix with a window that fits the marker's cells
  kEdge,    // the whole marker is fitted, or its blurred sides: corner_refinement.h
};

std::string CornerRefinementName(CornerRefinement refinement);

enum class SearchMode {
  kExhaustive,  // the whole of every frame
  kTracked,     // videos: around the markers of the previous frames, marker_tracking.h
};

std::string SearchModeName(SearchMode mode);

struct ArucoDetectionOptions {
  CornerRefinement corner_refinement = CornerRefinement::kEdge;
  // OpenCV's default of 0.03 loses a third of a sail's markers at 4K.
  double min_marker_perimeter_rate = 0.01;
  // OpenCV's default of 0.6 lets false ids in.
  double error_correction_rate = 0.3;
  bool inverted = false;
  bool estimate_formation = true;
  SearchMode search = SearchMode::kTracked;
  int full_search_interval = 15;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(ArucoDetectionOptions* options);

}  // namespace velamap
