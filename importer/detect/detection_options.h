// Options of detection. They are free of OpenCV, so that every room can include them.

#pragma once

#include <string>

namespace velamap {

enum class CornerRefinement {
  kNone,    // corners of the detector's polygon
  kSubpix,  // cv::cornerSubPix with a window that fits the marker's cells
  kEdge,    // fitted blurred edges, corner_refinement.h
};

CornerRefinement CornerRefinementFromName(const std::string& name);  // throws InputError
std::string CornerRefinementName(CornerRefinement refinement);

enum class SearchMode {
  kExhaustive,  // the whole of every frame
  kTracked,     // videos: around the markers of the frames before, marker_tracking.h
};

SearchMode SearchModeFromName(const std::string& name);  // throws InputError
std::string SearchModeName(SearchMode mode);

struct ArucoDetectionOptions {
  CornerRefinement corner_refinement = CornerRefinement::kEdge;
  // Smallest marker perimeter as a fraction of the larger image side. OpenCV's 0.03 loses a third
  // of a sail's markers at 4K.
  double min_marker_perimeter_rate = 0.01;
  // Fraction of the dictionary's error correction that is used. OpenCV's 0.6 lets false ids in.
  double error_correction_rate = 0.3;
  bool inverted = false;  // white marker on black ground
  // Edge corners: what camera and print do to edges is estimated from the first frames.
  bool estimate_formation = true;
  SearchMode search = SearchMode::kTracked;  // for videos; photographs are searched as a whole
  int full_search_interval = 15;  // tracked: every k-th frame that is read is searched as a whole

  void Check() const;  // throws InputError that names the option
};

}  // namespace velamap
