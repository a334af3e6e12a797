// Marker dictionaries: the predefined ones of OpenCV including the AprilTag families, the thesis's
// dictionary, dictionary files, and custom dictionaries.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/aruco.hpp>

#include "importer/layout/code_search.h"

namespace velamap {

struct Dictionary {
  std::string name;  // predefined name, file name without folder, or name of a custom dictionary
  cv::Ptr<cv::aruco::Dictionary> aruco;
};

// Takes a predefined name or the path of a dictionary file. Names are DICT_4X4_50 to
// DICT_ARUCO_ORIGINAL and DICT_APRILTAG_16h5 to 36h11, also without DICT_ and in lower case, and
// THESIS_3X3_130 (ThesisCodes()). A file is in the format of cv::aruco, from 3x3 bits on: nmarkers,
// markersize, maxCorrectionBits (0 if missing), and marker_0, marker_1 ... as strings of 0 and 1.
// If maxCorrectionBits is too large for the distance of the codes, it is lowered with a warning.
// Throws InputError that lists the names if the argument is neither a known name nor a readable
// file, and InputError that names the key if a key is missing or invalid or if two markers are the
// same.
Dictionary LoadDictionary(const std::string& name_or_path);

std::vector<std::string> PredefinedDictionaryNames();

// Whether the name is one of OpenCV's, which other programs know as well.
bool IsOpenCvName(const std::string& name);

int NumMarkers(const Dictionary& dictionary);

// The cells along a side of a marker, with its black border of `border_bits` cells.
int CellsPerSide(const Dictionary& dictionary, int border_bits);

// The dictionary corrects as many wrong bits as the minimum distance of the codes allows.
Dictionary MakeDictionary(const std::string& name, const CodeSet& codes);

// The cells within the border, one element per cell (CV_8UC1, 1 is white).
cv::Mat MarkerBits(const Dictionary& dictionary, int marker_id);

// The text of a dictionary file that LoadDictionary() and cv::aruco can read.
std::string DictionaryText(const Dictionary& dictionary);

// Draws the marker and its black border with one pixel per cell (CV_8UC1, zero is black). Row 0 is
// the side between the first and the second corner, column 0 the side between the first and the
// fourth.
cv::Mat MarkerCells(const Dictionary& dictionary, int marker_id, int border_bits);

// A marker whose cells were read in one of four rotations. `first_corner`, 0 to 3, is the index of
// its first corner in the order of reading, which begins at row 0, column 0.
struct ReadCode {
  int marker_id = 0;
  int first_corner = 0;
};

// The marker whose cells, as MarkerCells() draws them, are exactly these in one of the four
// rotations. Returns nothing if there is none, or if the border is not black.
std::optional<ReadCode> ReadCells(const Dictionary& dictionary, const cv::Mat& cells,
                                  int border_bits);

}  // namespace velamap
