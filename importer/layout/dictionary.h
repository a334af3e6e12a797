// Marker dictionaries: OpenCV's predefined ones, AprilTag families among them, and files.

#pragma once

#include <string>
#include <vector>

#include <opencv2/aruco.hpp>

namespace velamap {

struct Dictionary {
  std::string name;  // predefined name, or the file's name
  cv::Ptr<cv::aruco::Dictionary> aruco;
};

// A predefined name (DICT_4X4_50 ... DICT_ARUCO_ORIGINAL, DICT_APRILTAG_16h5 ... 36h11, also
// without DICT_ and in any case) or the path of a cv::aruco dictionary file with nmarkers,
// markersize, maxCorrectionBits and marker_0 ... as strings of 0 and 1 (3x3 bits and more). Throws
// InputError: neither a known name nor a readable file (lists the names), or a file with a missing
// key or wrong bits (names the key).
Dictionary LoadDictionary(const std::string& name_or_path);

std::vector<std::string> PredefinedDictionaryNames();

// One pixel a cell with the border, 8 bit, zero for black; row 0 runs from corner 0 to 1 and column
// 0 from corner 0 to 3.
cv::Mat MarkerCells(const Dictionary& dictionary, int marker_id, int border_bits);

}  // namespace velamap
