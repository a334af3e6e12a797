#include "tests/support/study/corner_comparison.h"

#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/camera/calibration.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/rigid3.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

// By frame.
std::vector<Rigid3> ReadPoses(const std::filesystem::path& path) {
  constexpr std::size_t kNumColumns = 8;
  std::ifstream in(path);
  std::vector<Rigid3> poses;
  for (const CsvRecord& record : ReadCsv(in, path.string())) {
    if (record.fields.front() == "frame") continue;
    std::vector<double> values(record.fields.size());
    bool is_whole = values.size() == kNumColumns;
    for (std::size_t i = 0; i < values.size(); ++i) {
      is_whole = ParseNumber(record.fields[i], &values[i]) && is_whole;
    }
    if (!is_whole) {
      throw InputError(fmt::format("{}: line {}: expected {} numbers; render the clip again",
                                   path.string(), record.line, kNumColumns));
    }
    poses.push_back({Eigen::Quaterniond(values[1], values[2], values[3], values[4]),
                     {values[5], values[6], values[7]}});
  }
  return poses;
}

std::optional<QuadCorners> ProjectMarker(const Camera& camera, const Rigid3& cam_from_world,
                                         const ShapeMarker* marker) {
  if (marker == nullptr) return std::nullopt;
  QuadCorners corners;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto x = ImageFromCam(camera, cam_from_world * *marker->x_in_shape_m[i + 1]);
    if (!x) return std::nullopt;
    corners[i] = *x;
  }
  return corners;
}

CornerComparison Compare(const MarkerDetection& found, const QuadCorners& truth) {
  CornerComparison comparison;
  comparison.marker_id = found.marker_id;
  comparison.is_fallback = found.is_fallback;
  comparison.side_px = QuadMeanSide(truth);
  comparison.side_error_px = QuadMeanSide(found.corners_in_image_px) - comparison.side_px;
  double squares = 0.0, normalized = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const double square = (found.corners_in_image_px[i] - truth[i]).squaredNorm();
    const double sigma_px = found.corner_sigma_px[i];
    squares += square;
    if (sigma_px > 0) normalized += square / (2 * sigma_px * sigma_px);
  }
  comparison.corner_error_px = std::sqrt(squares / kNumCorners);
  comparison.error_over_sigma = std::sqrt(normalized / kNumCorners);
  comparison.is_false = (CornerMean(found) - QuadCenter(truth)).norm() > comparison.side_px;
  return comparison;
}

}  // namespace

std::vector<CornerComparison> CompareCorners(const std::filesystem::path& clip_folder,
                                             const std::vector<DatabaseImage>& images) {
  const Camera camera = ReadCalibration((clip_folder / "camera.yml").string());
  const MarkerShape truth = ReadShapeCsv((clip_folder / "truth.csv").string());
  const std::vector<Rigid3> poses = ReadPoses(clip_folder / "poses.csv");
  std::vector<CornerComparison> comparisons;
  for (const DatabaseImage& image : images) {
    const std::optional<int> frame_number = image.detections.frame_number;
    if (!frame_number || *frame_number >= static_cast<int>(poses.size())) {
      throw InputError(
          fmt::format("{}: is not a frame of the clip in {}; give the database of its video",
                      image.detections.image_name, clip_folder.string()));
    }
    const Rigid3& cam_from_world = poses[static_cast<std::size_t>(*frame_number)];
    for (const MarkerDetection& found : image.detections.markers) {
      const auto corners =
          ProjectMarker(camera, cam_from_world, FindWholeMarker(truth, found.marker_id));
      CornerComparison comparison = corners ? Compare(found, *corners) : CornerComparison();
      comparison.marker_id = found.marker_id;
      comparison.frame_number = *frame_number;
      comparison.is_false = comparison.is_false || !corners;
      comparisons.push_back(comparison);
    }
  }
  return comparisons;
}

}  // namespace velamap
