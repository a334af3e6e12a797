#include "exporters/compare/section_comparison.h"

#include <algorithm>
#include <cmath>
#include <iterator>

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

SectionDifference Difference(const Section& section, const char* number, double factor,
                             const Estimate& value, const Estimate& reference) {
  SectionDifference difference{
      section.part, section.name, number, factor * value.value, factor * reference.value,
      std::nullopt, std::nullopt};
  if (value.sigma && reference.sigma) {
    difference.sigma = factor * std::hypot(*value.sigma, *reference.sigma);
    if (*difference.sigma > 0) {
      difference.significance = difference.Difference() / *difference.sigma;
    }
  }
  return difference;
}

void AddDifferences(const Section& section, const Section& reference, bool with_twist,
                    std::vector<SectionDifference>* differences) {
  const auto add = [&](const char* number, double factor, const Estimate& a, const Estimate& b) {
    differences->push_back(Difference(section, number, factor, a, b));
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

const Section* FindSection(const SectionReport& report, const Section& like) {
  const auto it =
      std::find_if(report.sections.begin(), report.sections.end(),
                   [&](const Section& s) { return s.part == like.part && s.name == like.name; });
  return it == report.sections.end() ? nullptr : &*it;
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

}  // namespace

SectionComparison CompareSections(const UncertainShape& shape, const UncertainShape& reference,
                                  const Alignment& alignment, const Layout& layout,
                                  const SectionOptions& options) {
  const PointCovariance* covariance =
      reference.covariance.IsEmpty() ? nullptr : &reference.covariance;
  const ShapeFrame frame =
      ChooseFrame(reference.shape, layout, std::nullopt,
                  FrameOfKnownPoints(FitKnownPoints(reference.shape, layout, covariance)));
  const Rigid3& frame_from_reference = frame.frame_from_shape;
  const SectionReport of_reference =
      CutInFrame(frame_from_reference, frame, reference, layout, options);
  const SectionReport of_shape = CutInFrame(frame_from_reference * alignment.reference_from_shape,
                                            frame, shape, layout, options);
  SectionComparison comparison;
  comparison.frame_name = frame.name;
  AddNotes(of_shape, "shape", &comparison.notes);
  AddNotes(of_reference, "reference", &comparison.notes);
  const bool with_twist = HaveSameTwistReference(of_shape, of_reference);
  if (!with_twist && !of_shape.sections.empty() && !of_reference.sections.empty()) {
    comparison.notes.push_back("twists cannot be compared: they have different references");
  }
  for (const Section& section : of_shape.sections) {
    const Section* other = FindSection(of_reference, section);
    if (other != nullptr) {
      AddDifferences(section, *other, with_twist, &comparison.differences);
    }
  }
  return comparison;
}

}  // namespace velamap
