// All steps for one frame: detection, colours, the filter of the layout, duplicates, rotations.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/chessboard.h"
#include "importer/detect/detection.h"
#include "importer/detect/detection_options.h"
#include "importer/detect/marker_location.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/pattern/image_formation.h"
#include "importer/rotation/rotation_ambiguity.h"
#include "importer/video/frame_source.h"

namespace velamap {

// Read by all threads and changed by none.
struct FrameDetector {
  ArucoDetectionOptions options;
  Dictionary dictionary;
  int border_bits = 1;
  AdjacencyGraph graph;
  CodeSymmetries symmetries;              // of markers with a rotational symmetry
  std::map<int, std::string> part_of_id;  // empty: every id is accepted
  std::vector<MarkerLook> looks;          // by id of the dictionary
  std::vector<double> sides_mm;           // likewise
  std::vector<std::vector<int>> lines;    // ids along the lines of the layout; for tracked search
  ImageFormation formation;               // of the camera and the print
  PriorShape prior_shape;                 // of markers that can be detected; may be empty
  // If set, the corners of this chessboard are detected instead of markers, and the other members
  // have no effect.
  std::optional<Chessboard> chessboard;
};

// Throws InputError for a dictionary that does not exist or has wrong bits, and for a layout that
// names an id that the dictionary does not have. Ignores markers of `prior_shape` that are missing
// in the dictionary or the layout.
FrameDetector MakeFrameDetector(const Layout& layout, const ArucoDetectionOptions& options,
                                const PriorShape& prior_shape = {});

FrameDetector MakeChessboardDetector(const Chessboard& board);

// The markers of the whole frame, or of regions of it, to a pixel. Thread-safe.
std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray);
std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                      const std::vector<cv::Rect>& regions);

// The places of markers that were not found but should be visible. Markers of the prior shape are
// expected at their reprojection, unless they are too small to be found; the others, or all where
// the frame cannot be placed in it, on the lines of the layout. Thread-safe.
std::vector<ExpectedMarker> ExpectInFrame(const FrameDetector& detector, const Camera& camera,
                                          const std::vector<MarkerQuad>& found,
                                          PriorShapeAgreement* agreement);

// Searches the whole frame, and the places of expected markers that this missed. Thread-safe.
std::vector<MarkerQuad> SearchInWholeFrame(const FrameDetector& detector, const Camera& camera,
                                           const cv::Mat& gray, PriorShapeAgreement* agreement);

// Large markers of the whole frame, in a quarter of the time. Thread-safe.
std::vector<MarkerQuad> SearchInFrameCoarsely(const FrameDetector& detector, const cv::Mat& gray);

// Locates one marker whose place is known to `reach_px`, as LocateMarker() does. Also returns
// nothing if a search would reject the marker. Thread-safe.
std::optional<QuadCorners> LocateInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                         int marker_id, const QuadCorners& expected,
                                         double reach_px);

// One line that describes everything on which the detections of a frame depend, so that a database
// never mixes two kinds. The codes of the dictionary and the parts and neighbours of the layout
// enter as a checksum.
std::string DescribeDetector(const FrameDetector& detector);

// The settings of `description` that `other` does not have, both made by DescribeDetector(); "none
// of these" if there are none.
std::string SettingsThatDiffer(const std::string& description, const std::string& other);

// Whether `description`, which DescribeDetector() has made, is of the dictionary and the layout of
// `detector`; its options may differ.
bool IsOfLayout(const std::string& description, const FrameDetector& detector);

// Throws InputError, naming both, if `description` is of another dictionary or border than the
// layout's. Nothing happens for a layout without a dictionary and for descriptions of other kinds.
// `database_path` is the database that holds the description.
void CheckDictionaryOf(const std::string& description, const Layout& layout,
                       const std::string& database_path);

// The steps after the search. `quads` are the markers found in the frame. Thread-safe.
FrameDetections DetectInFrame(const FrameDetector& detector, const Frame& frame,
                              const Camera& camera, const std::vector<MarkerQuad>& quads);

}  // namespace velamap
