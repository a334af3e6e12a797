#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "exporters/comparison_page/comparison_page.h"
#include "exporters/comparison_page/comparison_sections_json.h"
#include "exporters/comparison_page/comparison_words.h"
#include "exporters/report/html_page.h"
#include "importer/geometry/units.h"
#include "importer/text/json_text.h"

namespace velamap {
namespace {

using Json = ComparisonJsonValue;

Json VectorJson(const Eigen::Vector3d& x) {
  return {Rounded(x.x()), Rounded(x.y()), Rounded(x.z())};
}

bool IsDesign(const ComparisonPageInput& input) { return input.reference == nullptr; }

// Up and the view from the side to which the normals point, in the frame of the reference.
Json FrameJson(const ComparisonPageInput& input, const Eigen::Vector3d& normal) {
  const Comparison& first = input.series.front();
  const SectionComparison& sections = first.sections;
  // Up is that of the frame, as in the report, not that of the sail; z if the frame has none.
  const Eigen::Vector3d up = sections.up_in_reference.value_or(Eigen::Vector3d::UnitZ());
  Eigen::Vector3d forward = -(normal - normal.dot(up) * up);
  constexpr double kMinHorizontal = 0.1;
  if (forward.norm() < kMinHorizontal) forward = up.unitOrthogonal();
  return {{"name", sections.frame_name.empty() ? "that of the reference" : sections.frame_name},
          {"up", VectorJson(up)},
          {"forward", VectorJson(forward.normalized())}};
}

// Mean normal of the reference: of the field, or of the markers without one.
Eigen::Vector3d MeanNormal(const Comparison& comparison) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const DeflectionField& field : comparison.deflections.fields) {
    for (const Eigen::Vector3d& normal : field.reference.normals) sum += normal;
  }
  if (sum.norm() == 0) {
    for (const MarkerDeviation& marker : comparison.deviation.markers) sum += marker.normal;
  }
  return sum.normalized();
}

// "to leeward" if the normals point there, "to windward", or nothing without sections.
std::string PositiveSide(const Comparison& comparison, const Eigen::Vector3d& normal) {
  double agreement = 0.0;
  for (const Section& section : comparison.sections.of_reference.sections) {
    agreement +=
        (comparison.sections.frame_from_reference.rotation * normal).dot(section.depth_direction);
  }
  if (agreement == 0.0) return "";
  return agreement > 0 ? "to leeward" : "to windward";
}

std::string AlignedBy(const Alignment& alignment) {
  if (alignment.method == AlignmentMethod::kNone) return alignment.description;
  std::string method = AlignmentMethodName(alignment.method);
  std::replace(method.begin(), method.end(), '_', ' ');
  return method + ": " + alignment.description;
}

Json ShapeJson(const Comparison& comparison) {
  const ShapeDeviation& deviation = comparison.deviation;
  const Statistics& distance_m = deviation.distance_m;
  const Alignment& alignment = deviation.alignment;
  const double turn_rad =
      alignment.reference_from_shape.rotation.angularDistance(Eigen::Quaterniond::Identity());
  Json json = {{"name", comparison.name},
               {"alignment_by", AlignedBy(alignment)},
               {"turn_deg", Rounded(kDegPerRad * turn_rad)},
               {"num_markers", deviation.markers.size()},
               {"mean_mm", Rounded(kMmPerM * distance_m.mean)},
               {"rms_mm", Rounded(kMmPerM * distance_m.rms)},
               {"largest_mm", Rounded(kMmPerM * distance_m.MaxAbs())}};
  if (alignment.method != AlignmentMethod::kNone) {
    json["residual_mm"] = Rounded(kMmPerM * alignment.residual_m.rms);
  }
  if (deviation.scale) json["scale_percent"] = Rounded(100 * (*deviation.scale - 1));
  if (comparison.IsAgainstDesign()) {
    json["num_beyond_edge"] = deviation.num_beyond_edge;
    json["num_beside"] = deviation.num_beside;
  }
  if (deviation.num_with_sigma > 0) {
    json["num_with_sigma"] = deviation.num_with_sigma;
    json["num_significant"] = deviation.num_significant;
  }
  return json;
}

Json DistanceJson(const MarkerDeviation& marker) {
  Json json = {{"is_beside", !marker.is_over_surface}};
  if (marker.beside_m > 0) json["beside_mm"] = Rounded(kMmPerM * marker.beside_m);
  if (!marker.is_over_surface) return json;
  json["distance_mm"] = Rounded(kMmPerM * marker.distance_m);
  if (marker.sigma_m) json["sigma_mm"] = Rounded(kMmPerM * *marker.sigma_m);
  if (marker.significance) json["significance"] = Rounded(*marker.significance);
  return json;
}

// Markers are shown where the reference has them or, for a design, where the first shape has them.
Json MarkersJson(const ComparisonPageInput& input) {
  std::map<int, Json> by_id;
  for (std::size_t i = 0; i < input.series.size(); ++i) {
    const ShapeDeviation& deviation = input.series[i].deviation;
    for (const MarkerDeviation& compared : deviation.markers) {
      Json& json = by_id[compared.marker_id];
      if (json.is_null()) {
        const MarkerShape& shape = IsDesign(input) ? deviation.aligned_shape : *input.reference;
        const ShapeMarker& marker = *FindWholeMarker(shape, compared.marker_id);
        json = {{"id", compared.marker_id},
                {"part", compared.part},
                {"corners", Json::array()},
                {"centre", VectorJson(*marker.x_in_shape_m[0])},
                {"distances", std::vector<Json>(input.series.size())}};
        for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
          json["corners"].push_back(VectorJson(*marker.x_in_shape_m[corner]));
        }
      }
      json["distances"][i] = DistanceJson(compared);
    }
  }
  Json markers = Json::array();
  for (auto& [id, json] : by_id) markers.push_back(std::move(json));
  return markers;
}

// Flat lists in the format of vertex buffers; two triangles for each cell of the grids.
Json SurfaceJson(const DeflectionReport& deflections) {
  Json vertices = Json::array(), triangles = Json::array(), distances = Json::array();
  for (const DeflectionField& field : deflections.fields) {
    const SurfaceGrid& grid = field.reference;
    const int first = static_cast<int>(distances.size());
    for (std::size_t i = 0; i < grid.vertices_m.size(); ++i) {
      for (const double value : grid.vertices_m[i]) vertices.push_back(Rounded(value));
      const auto& deflection = field.deflections[i];
      distances.push_back(deflection ? Rounded(kMmPerM * deflection->distance_m) : Json());
    }
    for (int j = 0; j + 1 < grid.num_sections; ++j) {
      for (int i = 0; i + 1 < grid.num_points; ++i) {
        const int a = first + j * grid.num_points + i, b = a + 1, c = a + grid.num_points,
                  d = c + 1;
        for (const int vertex : {a, b, d, a, d, c}) triangles.push_back(vertex);
      }
    }
  }
  return {{"vertices", std::move(vertices)},
          {"triangles", std::move(triangles)},
          {"distances_mm", std::move(distances)}};
}

// The largest distance of all shapes, of markers and surfaces.
double LargestDistance_mm(const std::vector<Comparison>& series) {
  double largest_m = 0.0;
  for (const Comparison& comparison : series) {
    largest_m = std::max(largest_m, comparison.deviation.distance_m.MaxAbs());
    for (const DeflectionField& field : comparison.deflections.fields) {
      for (const auto& deflection : field.deflections) {
        if (deflection) largest_m = std::max(largest_m, std::abs(deflection->distance_m));
      }
    }
  }
  return kMmPerM * largest_m;
}

}  // namespace

std::string ComparisonJson(const ComparisonPageInput& input) {
  const Comparison& first = input.series.front();
  const Eigen::Vector3d normal = MeanNormal(first);
  const ComparisonVerdict verdict = JudgeComparison(input);
  Json json = {
      {"title", ComparisonTitle(input)},
      {"version", input.version},
      {"created", input.created},
      {"reference", input.reference_name},
      {"is_design", IsDesign(input)},
      {"color_limit_mm", Rounded(input.color_limit_mm.value_or(LargestDistance_mm(input.series)))},
      {"positive_side", PositiveSide(first, normal)},
      {"verdict", {{"text", verdict.text}, {"items", verdict.items}, {"level", verdict.level}}},
      {"frame", FrameJson(input, normal)}};
  json["shapes"] = Json::array();
  json["surfaces"] = Json::array();
  for (const Comparison& comparison : input.series) {
    json["shapes"].push_back(ShapeJson(comparison));
    const DeflectionReport& deflections = comparison.deflections;
    json["surfaces"].push_back(deflections.fields.empty() ? Json() : SurfaceJson(deflections));
  }
  json["numbers"] = NumbersJson(input.series);
  json["profiles"] = ProfilesJson(input);
  json["markers"] = MarkersJson(input);
  return EscapeForScript(JsonText(json));
}

}  // namespace velamap
