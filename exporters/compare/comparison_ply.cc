#include "exporters/compare/comparison_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "exporters/formats/diverging_color.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kMmPerM = 1e3;

double LimitOf(const ShapeDeviation& deviation, std::optional<double> color_limit_m) {
  return color_limit_m.value_or(
      std::max(std::abs(deviation.distance_m.min), std::abs(deviation.distance_m.max)));
}

std::string Header(const ShapeDeviation& deviation, double limit_m, bool has_sigma) {
  const std::string limit = fmt::format("{:g} mm", kMmPerM * limit_m);
  return fmt::format(
      "ply\nformat ascii 1.0\n"
      "comment velamap comparison, metres, frame of the reference, alignment: {}\n"
      "comment distance: positive on the side of the reference's normal\n"
      "comment colours: blue -{}, white 0, red +{}, grey beside the reference\n"
      "element vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float distance\n{}property int marker_id\nproperty int corner\n"
      "element face {}\nproperty list uchar int vertex_indices\nproperty int marker_id\n"
      "end_header\n",
      AlignmentMethodName(deviation.alignment.method), limit, limit,
      kNumCorners * deviation.markers.size(), has_sigma ? "property float sigma\n" : "",
      deviation.markers.size());
}

}  // namespace

void WriteComparisonPly(const ShapeDeviation& deviation, std::optional<double> color_limit_m,
                        std::ostream& out) {
  const double limit_m = LimitOf(deviation, color_limit_m);
  const bool has_sigma = std::all_of(deviation.markers.begin(), deviation.markers.end(),
                                     [](const auto& marker) { return marker.sigma_m.has_value(); });
  std::string text = Header(deviation, limit_m, has_sigma);
  for (const MarkerDeviation& deviating : deviation.markers) {
    const ShapeMarker* marker = FindWholeMarker(deviation.aligned_shape, deviating.marker_id);
    VELAMAP_CHECK(marker != nullptr);
    const Eigen::Vector3f normal = MarkerNormal(*marker).cast<float>();
    const Eigen::Array3d color = DivergingColor(
        deviating.is_over_surface ? std::optional(deviating.distance_m) : std::nullopt, limit_m);
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      const Eigen::Vector3d& x = *marker->x_in_shape_m[corner];
      text += fmt::format("{} {} {} {} {} {} {:.0f} {:.0f} {:.0f} {}", x.x(), x.y(), x.z(),
                          normal.x(), normal.y(), normal.z(), color[0], color[1], color[2],
                          static_cast<float>(deviating.distance_m));
      if (has_sigma) text += fmt::format(" {}", static_cast<float>(*deviating.sigma_m));
      text += fmt::format(" {} {}\n", deviating.marker_id, corner);
    }
  }
  // Corners 1..4 run clockwise seen from the front; a face runs the other way.
  for (std::size_t i = 0; i < deviation.markers.size(); ++i) {
    const std::size_t first = kNumCorners * i;
    text += fmt::format("4 {} {} {} {} {}\n", first, first + 3, first + 2, first + 1,
                        deviation.markers[i].marker_id);
  }
  out << text;
}

}  // namespace velamap
