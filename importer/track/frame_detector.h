// Everything that is done to one frame: detection, colours, the layout's filter, duplicates,
// rotations.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "importer/detect/detection_options.h"
#include "importer/detect/marker_alignment.h"
#include "importer/detect/marker_quad.h"
#include "importer/detect/rotation_ambiguity.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/refine/pattern_fit.h"
#include "importer/video/frame_source.h"

namespace velamap {

// Why an id that the layout does not name is left out.
inline constexpr char kNotInLayout[] = "not in layout";

// What every thread reads and none changes.
struct FrameDetector {
  ArucoDetectionOptions options;
  Dictionary dictionary;
  int border_bits = 1;
  AdjacencyGraph graph;
  CodeSymmetries symmetries;              // of the markers that look the same when turned
  std::map<int, std::string> part_of_id;  // empty: every id is welcome
  std::vector<MarkerLook> looks;          // of every id of the dictionary
  std::vector<std::vector<int>> lines;    // ids along those of the layout; tracked search only
  ResponseModel response;                 // of the camera, and the spread of the print's ink
  PriorShape prior_shape;                 // of markers that can be detected; may be empty
};

// Throws InputError for a dictionary that does not exist or has wrong bits. Markers of
// `prior_shape` that the dictionary lacks or the layout does not name are passed over.
FrameDetector MakeFrameDetector(const Layout& layout, const ArucoDetectionOptions& options,
                                const PriorShape& prior_shape = {});

// Where the markers of the whole frame, or of regions of it, are to a pixel. Thread-safe.
std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray);
std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                      const std::vector<cv::Rect>& regions);

// Where markers that are not found should be visible: by the prior shape, but none that is too
// small for a search to take; and on the layout's lines those that the prior shape does not hold,
// or all if the frame cannot be placed in it. Thread-safe.
std::vector<ExpectedMarker> ExpectInFrame(const FrameDetector& detector, const Camera& camera,
                                          const std::vector<MarkerQuad>& found,
                                          PriorShapeAgreement* agreement);

// The whole frame, and what is expected in it and was missed. Thread-safe.
std::vector<MarkerQuad> SearchInWholeFrame(const FrameDetector& detector, const Camera& camera,
                                           const cv::Mat& gray, PriorShapeAgreement* agreement);

// Large markers of the whole frame, in a quarter of the time. Thread-safe.
std::vector<MarkerQuad> SearchInFrameCoarsely(const FrameDetector& detector, const cv::Mat& gray);

// One marker whose place is known to `reach_px`; as LocateMarker().
// Nothing also where a search would take no marker. Thread-safe.
std::optional<QuadCorners> LocateInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                         int marker_id, const QuadCorners& expected,
                                         double reach_px);

// One line on everything that decides which detections a frame yields, so that one database never
// mixes two ways. The dictionary's codes and the layout's parts and neighbours go in as a checksum.
std::string DescribeDetector(const FrameDetector& detector);

// All else. `gray` is the frame in grey, `quads` what was found in it. Thread-safe.
FrameDetections DetectInFrame(const FrameDetector& detector, const Frame& frame,
                              const cv::Mat& gray, const std::vector<MarkerQuad>& quads);

}  // namespace velamap
