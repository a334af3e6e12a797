#include "exporters/compare/section_comparison.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "exporters/cloth/cloth_places.h"
#include "exporters/compare/comparison_sigma.h"
#include "exporters/datum/known_points.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_transform.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kPercent = 100.0;

// The markers in the frame.
MarkerShape InFrame(const Rigid3& frame_from_shape, MarkerShape shape) {
  MoveShape(frame_from_shape, nullptr, &shape);
  return shape;
}

// The sections of a shape without some of its markers. `offsets_m` are in the frame.
SectionReport CutInFrame(const Rigid3& frame_from_shape, const ShapeFrame& frame,
                         const UncertainShape& uncertain, const ClothOffsets& offsets_m,
                         const std::set<int>& left_out_ids, const Layout& layout,
                         const std::string& part) {
  SectionOptions options;
  options.part = part;
  MarkerShape shape;
  for (const ShapeMarker& marker : uncertain.shape.markers) {
    if (left_out_ids.count(marker.marker_id) == 0) shape.markers.push_back(marker);
  }
  if (uncertain.covariance.IsEmpty()) {
    MoveShape(frame_from_shape, nullptr, &shape);
    MoveCenters(offsets_m, &shape);
    return ComputeSections(shape, frame, layout, nullptr, options);
  }
  const PointCovariance covariance =
      RotateCovariance(frame_from_shape.rotation, uncertain.covariance);
  MoveShape(frame_from_shape, &covariance, &shape);
  MoveCenters(offsets_m, &shape);
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
  if (with_twist && section.twist_deg && reference.twist_deg) {
    add("twist_deg", 1.0, *section.twist_deg, *reference.twist_deg);
  }
}

// Whether two curves of a line run between the same markers.
bool HaveSameEnds(const Section& a, const Section& b) {
  return a.markers.front().marker_id == b.markers.front().marker_id &&
         a.markers.back().marker_id == b.markers.back().marker_id;
}

// The reference of the twist: the boom or a section; empty for a part with neither.
std::string TwistReference(const SectionReport& report, const std::string& part) {
  const auto rig = std::find_if(report.rigs.begin(), report.rigs.end(),
                                [&](const RigNumbers& item) { return item.part == part; });
  if (rig == report.rigs.end()) return "";
  if (rig->twist_reference == "boom") return rig->twist_reference;
  return rig->reference_section.empty() ? "" : "section " + rig->reference_section;
}

void AddNotes(const SectionReport& report, const char* whose, std::vector<std::string>* notes) {
  for (const MissingSection& missing : report.missing) {
    notes->push_back(
        fmt::format("{}: {} {}: {}", whose, missing.part, missing.name, missing.reason));
  }
  for (const std::string& note : report.notes) notes->push_back(fmt::format("{}: {}", whose, note));
}

// The markers of the lines beyond the outermost ones that are whole in both shapes. With them,
// chords of different lengths would be compared. A line with too few common markers for a section
// keeps its markers, so that the notes give the reason why one of the shapes has no section there.
std::set<int> MarkersBeyondCommonEnds(const MarkerShape& shape, const MarkerShape& reference,
                                      const Layout& layout) {
  const auto is_common = [&](int id) {
    return FindWholeMarker(shape, id) != nullptr && FindWholeMarker(reference, id) != nullptr;
  };
  std::set<int> beyond;
  for (const LayoutPart& part : layout.parts) {
    for (const MarkerLine& line : part.horizontal) {
      const std::vector<int>& ids = line.marker_ids;
      if (std::count_if(ids.begin(), ids.end(), is_common) < SectionOptions().min_markers) continue;
      beyond.insert(ids.begin(), std::find_if(ids.begin(), ids.end(), is_common));
      beyond.insert(ids.rbegin(), std::find_if(ids.rbegin(), ids.rend(), is_common));
    }
  }
  return beyond;
}

// Cuts both shapes along the lines of the reference's frame, between the same markers.
SectionComparison CutBoth(const UncertainShape& shape, const UncertainShape& reference,
                          const Alignment& alignment, const Layout& layout,
                          const std::string& wanted_part) {
  const PointCovariance* covariance =
      reference.covariance.IsEmpty() ? nullptr : &reference.covariance;
  const ShapeFrame frame =
      ChooseFrame(reference.shape, layout, std::nullopt,
                  FrameOfKnownPoints(FitKnownPoints(reference.shape, layout, covariance)));
  SectionComparison comparison;
  comparison.frame_name = frame.name;
  comparison.frame_from_reference = frame.frame_from_shape;
  if (frame.up_in_frame) {
    comparison.up_in_reference = frame.frame_from_shape.rotation.conjugate() * *frame.up_in_frame;
  }
  const std::set<int> beyond = MarkersBeyondCommonEnds(shape.shape, reference.shape, layout);
  const Rigid3 frame_from_shape = frame.frame_from_shape * alignment.reference_from_shape;
  // The same for both, so that the noise of the bends, and markers that one of them lacks, do not
  // count as differences.
  ClothOffsets offsets_m =
      OffsetsToCloth(InFrame(frame.frame_from_shape, reference.shape), layout, frame.up_in_frame);
  offsets_m.merge(
      OffsetsToCloth(InFrame(frame_from_shape, shape.shape), layout, frame.up_in_frame));
  comparison.of_reference =
      CutInFrame(frame.frame_from_shape, frame, reference, offsets_m, beyond, layout, wanted_part);
  comparison.of_shape =
      CutInFrame(frame_from_shape, frame, shape, offsets_m, beyond, layout, wanted_part);
  return comparison;
}

// Adds the differences of the sections that both shapes have, and notes on the others.
void CompareCuts(bool is_exact, SectionComparison* comparison) {
  std::vector<std::string>& notes = comparison->notes;
  std::set<std::string> parts_without_twist;
  for (const Section& section : comparison->of_shape.sections) {
    const Section* other = FindSection(comparison->of_reference, section.part, section.name);
    if (other == nullptr) continue;
    if (!HaveSameEnds(section, *other)) {
      notes.push_back(fmt::format(
          "{} {}: not compared: too few of its markers are whole in both, and the chords differ",
          section.part, section.name));
      continue;
    }
    const std::string missing = MissingEndsText(section);
    if (!missing.empty()) {
      notes.push_back(fmt::format("{} {}: compared over the markers of both, {}", section.part,
                                  section.name, missing));
    }
    const bool with_twist = TwistReference(comparison->of_shape, section.part) ==
                            TwistReference(comparison->of_reference, section.part);
    if (!with_twist) parts_without_twist.insert(section.part);
    AddDifferences(section, *other, with_twist, is_exact, &comparison->differences);
  }
  AddNotes(comparison->of_shape, "shape", &notes);
  AddNotes(comparison->of_reference, "reference", &notes);
  for (const std::string& part : parts_without_twist) {
    notes.push_back(
        fmt::format("twists of {} cannot be compared: they have different references", part));
  }
}

}  // namespace

const Section* FindSection(const SectionReport& report, const std::string& part,
                           const std::string& name) {
  const auto it = std::find_if(report.sections.begin(), report.sections.end(),
                               [&](const Section& s) { return s.part == part && s.name == name; });
  return it == report.sections.end() ? nullptr : &*it;
}

MarkerShape MarkersOnSurface(const ShapeDeviation& deviation) {
  MarkerShape moved;
  for (const MarkerDeviation& compared : deviation.markers) {
    if (!compared.is_over_surface) continue;
    ShapeMarker marker = *FindWholeMarker(deviation.aligned_shape, compared.marker_id);
    marker.sigma_m = {};
    if (deviation.surface_sigma_m > 0) {
      marker.sigma_m.fill(Eigen::Vector3d::Constant(deviation.surface_sigma_m));
    }
    // Moves the marker as a whole, because its corners may lie far beyond the edge of the design.
    for (auto& x : marker.x_in_shape_m) *x -= compared.distance_m * compared.normal;
    moved.markers.push_back(marker);
  }
  return moved;
}

SectionComparison CompareSections(const UncertainShape& shape, const UncertainShape& reference,
                                  const Alignment& alignment, const Layout& layout,
                                  const std::string& part) {
  SectionComparison comparison = CutBoth(shape, reference, alignment, layout, part);
  CompareCuts(false, &comparison);
  return comparison;
}

SectionComparison CompareSectionsOfDesign(const UncertainShape& shape,
                                          const ShapeDeviation& deviation, const Layout& layout,
                                          const std::string& part) {
  const MarkerShape on_surface = MarkersOnSurface(deviation);
  const bool is_exact = !(deviation.surface_sigma_m > 0);
  SectionComparison comparison = CutBoth(shape, {on_surface, CovarianceFromSigmas(on_surface)},
                                         deviation.alignment, layout, part);
  CompareCuts(is_exact, &comparison);
  return comparison;
}

}  // namespace velamap
