// Marker dictionaries: OpenCV's predefined ones with the AprilTag families, the thesis's, files,
// and custom ones.

#pragma once

#include <string>
#include <vector>

#include <opencv2/aruco.hpp>

#include "importer/layout/code_search.h"

namespace velamap {

struct Dictionary {
  std::string name;  // predefined name, or the file's name
  cv::Ptr<cv::aruco::Dictionary> aruco;
};

// Takes a predefined name (DICT_4X4_50 ... DICT_ARUCO_ORIGINAL, DICT_APRILTAG_16h5 ... 36h11, also
// without DICT_ and in lower case; THESIS_3X3_130, see ThesisCodes()) or the path of a cv::aruco
// dictionary file with nmarkers, markersize, maxCorrectionBits and marker_0 ... as strings of 0 and
// 1 (3x3 bits and more). Throws InputError that lists the names if the text is neither a known name
// nor a readable file, or names the key of the file that is missing or has wrong bits.
Dictionary LoadDictionary(const std::string& name_or_path);

std::vector<std::string> PredefinedDictionaryNames();

// Whether the name is one of OpenCV's, which other programs also know.
bool IsOpenCvName(const std::string& name);

int NumMarkers(const Dictionary& dictionary);

// Corrects as many wrong bits as the distance of the codes allows.
Dictionary MakeDictionary(const std::string& name, const CodeSet& codes);

// The text of a dictionary file, which LoadDictionary() and cv::aruco read.
std::string DictionaryText(const Dictionary& dictionary);

// Draws the marker and its border with one pixel per cell, 8 bit, zero for black. Row 0 runs from
// corner 0 to 1 and column 0 from corner 0 to 3.
cv::Mat MarkerCells(const Dictionary& dictionary, int marker_id, int border_bits);

}  // namespace velamap
