#include "exporters/comparison_page/comparison_sections_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "exporters/comparison_page/comparison_words.h"

namespace velamap {
namespace {

using Json = ComparisonJsonValue;

constexpr int kNumProfilePoints = 61;

// The one in the same row of the table of numbers; null without one.
const SectionDifference* FindDifference(const std::vector<SectionDifference>& differences,
                                        const SectionDifference& like) {
  const auto it =
      std::find_if(differences.begin(), differences.end(), [&](const SectionDifference& d) {
        return d.part == like.part && d.section == like.section && d.number == like.number;
      });
  return it == differences.end() ? nullptr : &*it;
}

// The rows of all shapes, each once, in the order of the first shape that has it.
std::vector<SectionDifference> AllNumbers(const std::vector<Comparison>& series) {
  std::vector<SectionDifference> all;
  for (const Comparison& comparison : series) {
    for (const SectionDifference& d : comparison.sections.differences) {
      if (FindDifference(all, d) == nullptr) all.push_back(d);
    }
  }
  return all;
}

// The profile with its chord on that of the reference it is compared with, and as it lies beside
// `reference`, which is drawn, mm. The two references differ where the shape lacks markers at an
// end of the line. Against a design, the sections of each shape are in a frame of their own.
Json CurveJson(const std::string& name, const Section& section, const Section& own_reference,
               const Section& reference, const Rigid3& reference_frame_from_frame) {
  Json own = Json::array(), placed = Json::array();
  for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
    const auto add = [](const ProfilePoint& p, Json* points) {
      points->push_back({std::round(1e5 * p.chordwise_m) / 100, std::round(1e5 * p.depth_m) / 100});
    };
    const Eigen::Vector3d x_on_chord_m = EvaluateCurve(own_reference.curve, 0.0) +
                                         point.chordwise_m * own_reference.chord_direction +
                                         point.depth_m * own_reference.depth_direction;
    add(ProfilePointOf(reference, reference_frame_from_frame * x_on_chord_m), &own);
    add(ProfilePointOf(reference, reference_frame_from_frame * point.x_in_frame_m), &placed);
  }
  return {{"name", name}, {"own", std::move(own)}, {"placed", std::move(placed)}};
}

// A section of the reference, and the comparison whose markers give it.
struct DrawnSection {
  const SectionComparison* comparison;
  const Section* section;
};

// The sections that the reference of any shape has, each once, from that of the first shape which
// has it; by part, from the lowest up, as in the reports.
std::vector<DrawnSection> SectionsOfReferences(const std::vector<Comparison>& series) {
  std::vector<DrawnSection> all;
  for (const Comparison& comparison : series) {
    auto place = all.begin();
    for (const Section& section : comparison.sections.of_reference.sections) {
      const auto found = std::find_if(all.begin(), all.end(), [&](const DrawnSection& drawn) {
        return drawn.section->part == section.part && drawn.section->name == section.name;
      });
      const bool is_new = found == all.end();
      place = is_new ? all.insert(place, {&comparison.sections, &section}) : found;
      ++place;
    }
  }
  return all;
}

}  // namespace

ComparisonJsonValue Rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

// Each shape is compared with the reference at its own markers, so that the reference's number is
// not the same for all shapes: a design is cut where the markers of each shape lie on it.
ComparisonJsonValue NumbersJson(const std::vector<Comparison>& series) {
  Json rows = Json::array();
  for (const SectionDifference& number : AllNumbers(series)) {
    Json values = Json::array();
    std::set<double> references;
    for (const Comparison& comparison : series) {
      const SectionDifference* d = FindDifference(comparison.sections.differences, number);
      if (d == nullptr) {
        values.push_back(nullptr);
        continue;
      }
      Json value = {{"value", Rounded(d->value)}, {"difference", Rounded(d->Difference())}};
      if (d->sigma) value["sigma"] = Rounded(*d->sigma);
      value["is_significant"] = d->IsSignificant();
      values.push_back(std::move(value));
      references.insert(Rounded(d->reference).get<double>());
    }
    Json row = {{"section", SectionName(series, number.part, number.section)},
                {"number", NumberName(number.number)},
                {"unit", NumberUnit(number.number)},
                {"values", std::move(values)}};
    if (references.size() == 1) row["reference"] = *references.begin();
    row["reference_range"] = Json::array({*references.begin(), *references.rbegin()});
    rows.push_back(std::move(row));
  }
  return rows;
}

ComparisonJsonValue ProfilesJson(const ComparisonPageInput& input) {
  Json profiles = Json::array();
  for (const DrawnSection& drawn : SectionsOfReferences(input.series)) {
    const Section& reference = *drawn.section;
    Json curves =
        Json::array({CurveJson(input.reference_name, reference, reference, reference, Rigid3())});
    for (const Comparison& comparison : input.series) {
      const auto find_section = [&](const auto& sections) {
        return FindSection(sections, reference.part, reference.name);
      };
      const Section* section = find_section(comparison.sections.of_shape);
      const Section* own_reference = find_section(comparison.sections.of_reference);
      if (section == nullptr || own_reference == nullptr) continue;
      const Rigid3 drawn_from_frame = drawn.comparison->frame_from_reference *
                                      Inverse(comparison.sections.frame_from_reference);
      curves.push_back(
          CurveJson(comparison.name, *section, *own_reference, reference, drawn_from_frame));
    }
    profiles.push_back({{"section", SectionName(input.series, reference.part, reference.name)},
                        {"curves", std::move(curves)}});
  }
  return profiles;
}

}  // namespace velamap
