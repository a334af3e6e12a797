#include "importer/track/frame_detector.h"

#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/detect/corner_colors.h"
#include "importer/detect/duplicates.h"
#include "importer/detect/marker_search.h"
#include "importer/geometry/units.h"
#include "importer/refine/marker_detector.h"
#include "importer/track/line_expectation.h"
#include "importer/track/prior_shape_expectation.h"

namespace velamap {
namespace {

std::string PriorShapeText(const PriorShape& prior_shape) {
  std::string text;
  for (const auto& [id, in_shape_m] : prior_shape) {
    text += fmt::format("|{}", id);
    for (const Eigen::Vector3d& x : in_shape_m) {
      text += fmt::format(" {} {} {}", x.x(), x.y(), x.z());
    }
  }
  return text;
}

// The dictionary must have all ids of the layout.
void CheckLayoutIds(const Layout& layout, const Dictionary& dictionary) {
  std::vector<int> ids = MarkerIds(layout);
  for (const auto& [id, length_m] : layout.marker_lengths_m) ids.push_back(id);
  const int num_markers = NumMarkers(dictionary);
  for (const int id : ids) {
    if (id < num_markers) continue;
    throw InputError(
        fmt::format("--layout_path: the layout names marker {}, which the dictionary {} does not "
                    "have (its ids are 0 to {}); correct the id or the dictionary",
                    id, dictionary.name, num_markers - 1));
  }
}

std::string DescribeCodes(const std::string& dictionary_name, int border_bits) {
  return fmt::format("dictionary={} border_bits={}", dictionary_name, border_bits);
}

// A checksum of what dictionary and layout tell an import. Only a tracked search uses the lines.
std::string DescribeLayout(const FrameDetector& detector, SearchMode search) {
  std::string known;
  const cv::Mat& bytes = detector.dictionary.aruco->bytesList;
  known.append(reinterpret_cast<const char*>(bytes.data), bytes.total() * bytes.elemSize());
  for (const auto& [id, part] : detector.part_of_id) known += fmt::format("|{} {}", id, part);
  for (const auto& [id, neighbors] : detector.graph) {
    known += fmt::format("|{}: {}", id, fmt::join(neighbors, " "));
  }
  if (search == SearchMode::kTracked) {
    for (const std::vector<int>& line : detector.lines) {
      known += fmt::format("|line {}", fmt::join(line, " "));
    }
  }
  return fmt::format("dictionary_and_layout={:016x}", Hash(known));
}

}  // namespace

FrameDetector MakeFrameDetector(const Layout& layout, const ArucoDetectionOptions& options,
                                const PriorShape& prior_shape) {
  FrameDetector detector;
  detector.options = options;
  detector.dictionary = LoadDictionary(layout.dictionary);
  detector.border_bits = layout.border_bits;
  detector.graph = BuildAdjacencyGraph(layout);
  for (int id = 0; id < NumMarkers(detector.dictionary); ++id) {
    detector.looks.push_back(
        {MarkerCells(detector.dictionary, id, layout.border_bits), options.inverted});
    detector.sides_mm.push_back(kMmPerM * MarkerLength(layout, id));
  }
  CheckLayoutIds(layout, detector.dictionary);
  detector.symmetries = FindCodeSymmetries(detector.dictionary);
  for (const int id : MarkerIds(layout)) detector.part_of_id[id] = PartOfMarker(layout, id);
  if (options.search == SearchMode::kTracked) detector.lines = LinesOfLayout(layout);
  for (const auto& [id, in_shape_m] : prior_shape) {
    const bool is_known = detector.part_of_id.empty() || detector.part_of_id.count(id) > 0;
    if (is_known && id < NumMarkers(detector.dictionary)) detector.prior_shape[id] = in_shape_m;
  }
  return detector;
}

FrameDetector MakeChessboardDetector(const Chessboard& board) {
  FrameDetector detector;
  detector.chessboard = board;
  detector.options.search = SearchMode::kExhaustive;
  // The corners of a chessboard are symmetric, so nothing moves them inwards or outwards.
  detector.options.estimate_formation = false;
  return detector;
}

std::string DescribeDetector(const FrameDetector& detector) {
  if (detector.chessboard) return ChessboardName(*detector.chessboard);
  // Earlier versions searched exhaustively without naming it.
  std::string search;
  if (detector.options.search == SearchMode::kTracked) {
    search =
        fmt::format(" search={} full_search_interval={}", SearchModeName(detector.options.search),
                    detector.options.full_search_interval);
  }
  // Databases of earlier versions hold the prior shape under the name map.
  if (!detector.prior_shape.empty()) {
    search += fmt::format(" map={:016x}", Hash(PriorShapeText(detector.prior_shape)));
  }
  if (detector.options.corner_refinement == CornerRefinement::kEdge &&
      detector.options.estimate_formation) {
    search += " formation=estimated";
  }
  return fmt::format(
      "{} corner_refinement={} min_marker_perimeter_rate={} error_correction_rate={} inverted={} "
      "{}{}",
      DescribeCodes(detector.dictionary.name, detector.border_bits),
      CornerRefinementName(detector.options.corner_refinement),
      detector.options.min_marker_perimeter_rate, detector.options.error_correction_rate,
      detector.options.inverted ? 1 : 0, DescribeLayout(detector, detector.options.search), search);
}

std::string SettingsThatDiffer(const std::string& description, const std::string& other) {
  const std::string others = " " + other + " ";
  std::istringstream settings(description);
  std::string text;
  for (std::string setting; settings >> setting;) {
    if (others.find(" " + setting + " ") != std::string::npos) continue;
    text += (text.empty() ? "" : " ") + setting;
  }
  return text.empty() ? "none of these" : text;
}

bool IsOfLayout(const std::string& description, const FrameDetector& detector) {
  for (const SearchMode search : {SearchMode::kTracked, SearchMode::kExhaustive}) {
    if (description.find(DescribeLayout(detector, search)) != std::string::npos) return true;
  }
  return false;
}

void CheckDictionaryOf(const std::string& description, const Layout& layout,
                       const std::string& database_path) {
  if (layout.dictionary.empty() || description.rfind("dictionary=", 0) != 0) return;
  const std::string of_layout =
      DescribeCodes(LoadDictionary(layout.dictionary).name, layout.border_bits);
  const std::size_t end = description.find(' ', description.find(" border_bits=") + 1);
  const std::string of_database = description.substr(0, end);
  if (of_database == of_layout) return;
  throw InputError(
      fmt::format("--layout_path: the layout has {}, but {} holds markers of {}; give the layout "
                  "of the import, "
                  "or import again",
                  of_layout, database_path, of_database));
}

std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray) {
  return SearchMarkers(gray, detector.dictionary, detector.border_bits, detector.options);
}

std::vector<MarkerQuad> SearchInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                      const std::vector<cv::Rect>& regions) {
  return SearchMarkers(gray, detector.dictionary, detector.border_bits, detector.options, regions);
}

std::optional<QuadCorners> LocateInFrame(const FrameDetector& detector, const cv::Mat& gray,
                                         int marker_id, const QuadCorners& expected,
                                         double reach_px) {
  const auto idx = static_cast<std::size_t>(marker_id);
  if (idx >= detector.looks.size()) return std::nullopt;  // tracks may come from a database
  const MarkerLook& look = detector.looks[idx];
  const auto located = LocateMarker(gray, expected, look, reach_px);
  if (!located || !IsSearchable(*located, gray.size(), detector.options)) return std::nullopt;
  return located;
}

std::vector<ExpectedMarker> ExpectInFrame(const FrameDetector& detector, const Camera& camera,
                                          const std::vector<MarkerQuad>& found,
                                          PriorShapeAgreement* agreement) {
  std::vector<ExpectedMarker> all;
  const auto view = PlaceInPriorShape(detector.prior_shape, camera, found, agreement);
  if (view) {
    for (const ExpectedMarker& expected :
         ExpectByPriorShape(detector.prior_shape, camera, *view, found)) {
      if (IsLargeEnough(expected.quad.corners_px, {camera.width_px, camera.height_px},
                        detector.options)) {
        all.push_back(expected);
      }
    }
  }
  for (const ExpectedMarker& expected : ExpectOnLines(detector.lines, found)) {
    const bool is_in_prior_shape = detector.prior_shape.count(expected.quad.marker_id) > 0;
    if (!view || !is_in_prior_shape) all.push_back(expected);
  }
  return all;
}

std::vector<MarkerQuad> SearchInWholeFrame(const FrameDetector& detector, const Camera& camera,
                                           const cv::Mat& gray, PriorShapeAgreement* agreement) {
  std::vector<MarkerQuad> quads = SearchInFrame(detector, gray);
  for (const auto& [quad, reach_px] : ExpectInFrame(detector, camera, quads, agreement)) {
    const auto located = LocateInFrame(detector, gray, quad.marker_id, quad.corners_px, reach_px);
    if (located) quads.push_back({quad.marker_id, *located});
  }
  return RemoveNested(std::move(quads));
}

std::vector<MarkerQuad> SearchInFrameCoarsely(const FrameDetector& detector, const cv::Mat& gray) {
  constexpr double kReachPx = 3.0;  // 1.5 px at half the resolution
  std::vector<MarkerQuad> quads;
  for (const MarkerQuad& coarse :
       SearchMarkersCoarsely(gray, detector.dictionary, detector.border_bits, detector.options)) {
    const auto located =
        LocateInFrame(detector, gray, coarse.marker_id, coarse.corners_px, kReachPx);
    if (located) quads.push_back({coarse.marker_id, *located});
  }
  return quads;
}

FrameDetections DetectInFrame(const FrameDetector& detector, const Frame& frame,
                              const Camera& camera, const std::vector<MarkerQuad>& quads) {
  FrameDetections detections{frame.image_name, frame.frame_number, frame.time_s, {}, {}};
  std::vector<MarkerDetection> candidates;
  for (MarkerDetection& marker :
       RefineMarkers(frame.gray, quads, detector.dictionary, detector.border_bits, detector.options,
                     detector.formation, detector.sides_mm, &camera)) {
    const auto part = detector.part_of_id.find(marker.marker_id);
    if (part != detector.part_of_id.end()) marker.part = part->second;
    if (detector.part_of_id.empty() || part != detector.part_of_id.end()) {
      candidates.push_back(marker);
    } else {
      detections.rejected.push_back({marker, kNotInLayout});
    }
  }
  ResolvedDetections resolved = ResolveDuplicates(std::move(candidates), detector.graph);
  detections.markers = std::move(resolved.markers);
  std::move(resolved.rejected.begin(), resolved.rejected.end(),
            std::back_inserter(detections.rejected));
  ResolveRotations(detector.symmetries, detector.graph, &detections.markers, &detections.rejected);
  AddColors(frame, &detections);
  return detections;
}

}  // namespace velamap
