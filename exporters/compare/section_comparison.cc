#include "exporters/compare/section_comparison.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "exporters/datum/known_points.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_transform.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kPercent = 100.0;

SectionReport CutInFrame(const Rigid3& frame_from_shape, const ShapeFrame& frame,
                         const UncertainShape& uncertain, const Layout& layout,
                         const SectionOptions& options) {
  MarkerShape shape = uncertain.shape;
  if (uncertain.covariance.IsEmpty()) {
    MoveShape(frame_from_shape, nullptr, &shape);
    return ComputeSections(shape, frame, layout, nullptr, options);
  }
  const PointCovariance covariance =
      RotateCovariance(frame_from_shape.rotation, uncertain.covariance);
  MoveShape(frame_from_shape, &covariance, &shape);
  return ComputeSections(shape, frame, layout, &covariance, options);
}

// `is_exact`: the reference has no noise.
SectionDifference Difference(const Section& section, const char* number, double factor,
                             const Estimate& value, const Estimate& reference, bool is_exact) {
  SectionDifference difference{
      section.part, section.name, number, factor * value.value, factor * reference.value,
      std::nullopt, std::nullopt};
  if (value.sigma && (reference.sigma || is_exact)) {
    const double sigma_of_reference = is_exact ? 0.0 : *reference.sigma;
    difference.sigma = factor * std::hypot(*value.sigma, sigma_of_reference);
    if (*difference.sigma > 0) {
      difference.significance = difference.Difference() / *difference.sigma;
    }
  }
  return difference;
}

void AddDifferences(const Section& section, const Section& reference, bool with_twist,
                    bool is_exact, std::vector<SectionDifference>* differences) {
  const auto add = [&](const char* number, double factor, const Estimate& a, const Estimate& b) {
    differences->push_back(Difference(section, number, factor, a, b, is_exact));
  };
  add("chord_mm", kMmPerM, section.chord_m, reference.chord_m);
  add("camber_percent", kPercent, section.camber, reference.camber);
  if (section.draft_position && reference.draft_position) {
    add("draft_position_percent", kPercent, *section.draft_position, *reference.draft_position);
  }
  add("entry_angle_deg", 1.0, section.entry_angle_deg, reference.entry_angle_deg);
  add("exit_angle_deg", 1.0, section.exit_angle_deg, reference.exit_angle_deg);
  if (with_twist) add("twist_deg", 1.0, section.twist_deg, reference.twist_deg);
}

// The reference of the twists of each part, as part and name.
std::vector<std::string> LowestSections(const SectionReport& report) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    if (i == 0 || report.sections[i - 1].part != section.part) {
      names.push_back(section.part + " " + section.name);
    }
  }
  return names;
}

bool HaveSameTwistReference(const SectionReport& a, const SectionReport& b) {
  return a.twist_reference == b.twist_reference &&
         (a.twist_reference == "boom" || LowestSections(a) == LowestSections(b));
}

void AddNotes(const SectionReport& report, const char* whose, std::vector<std::string>* notes) {
  for (const MissingSection& missing : report.missing) {
    notes->push_back(
        fmt::format("{}: {} {}: {}", whose, missing.part, missing.name, missing.reason));
  }
  for (const std::string& note : report.notes) notes->push_back(fmt::format("{}: {}", whose, note));
}

SectionComparison Compare(const UncertainShape& shape, const UncertainShape& reference,
                          bool is_exact, const Alignment& alignment, const Layout& layout,
                          const SectionOptions& options) {
  const PointCovariance* covariance =
      reference.covariance.IsEmpty() ? nullptr : &reference.covariance;
  const ShapeFrame frame =
      ChooseFrame(reference.shape, layout, std::nullopt,
                  FrameOfKnownPoints(FitKnownPoints(reference.shape, layout, covariance)));
  SectionComparison comparison;
  comparison.frame_name = frame.name;
  comparison.frame_from_reference = frame.frame_from_shape;
  comparison.of_reference = CutInFrame(frame.frame_from_shape, frame, reference, layout, options);
  comparison.of_shape = CutInFrame(frame.frame_from_shape * alignment.reference_from_shape, frame,
                                   shape, layout, options);
  AddNotes(comparison.of_shape, "shape", &comparison.notes);
  AddNotes(comparison.of_reference, "reference", &comparison.notes);
  const std::vector<Section>& sections = comparison.of_shape.sections;
  const bool with_twist = HaveSameTwistReference(comparison.of_shape, comparison.of_reference);
  if (!with_twist && !sections.empty() && !comparison.of_reference.sections.empty()) {
    comparison.notes.push_back("twists cannot be compared: they have different references");
  }
  for (const Section& section : sections) {
    const Section* other = FindSection(comparison.of_reference, section.part, section.name);
    if (other != nullptr) {
      AddDifferences(section, *other, with_twist, is_exact, &comparison.differences);
    }
  }
  return comparison;
}

}  // namespace

const Section* FindSection(const SectionReport& report, const std::string& part,
                           const std::string& name) {
  const auto it = std::find_if(report.sections.begin(), report.sections.end(),
                               [&](const Section& s) { return s.part == part && s.name == name; });
  return it == report.sections.end() ? nullptr : &*it;
}

MarkerShape MarkersOnSurface(const MeshDistance& surface, const ShapeDeviation& deviation) {
  MarkerShape moved;
  for (const MarkerDeviation& compared : deviation.markers) {
    if (!compared.is_over_surface) continue;
    ShapeMarker marker = *FindWholeMarker(deviation.aligned_shape, compared.marker_id);
    marker.sigma_m = {};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      Eigen::Vector3d& x = *marker.x_in_shape_m[corner];
      const MeshFoot foot = surface.Project(x);
      x -= foot.distance_m * foot.normal;
      sum += x;
    }
    marker.x_in_shape_m[0] = sum / kNumCorners;
    moved.markers.push_back(marker);
  }
  return moved;
}

SectionComparison CompareSections(const UncertainShape& shape, const UncertainShape& reference,
                                  const Alignment& alignment, const Layout& layout,
                                  const SectionOptions& options) {
  return Compare(shape, reference, false, alignment, layout, options);
}

SectionComparison CompareSections(const UncertainShape& shape, const MeshDistance& reference,
                                  const ShapeDeviation& deviation, const Layout& layout,
                                  const SectionOptions& options) {
  return Compare(shape, {MarkersOnSurface(reference, deviation), {}}, true, deviation.alignment,
                 layout, options);
}

}  // namespace velamap
