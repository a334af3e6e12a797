#include "exporters/comparison_page/comparison_words.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/comparison_page/comparison_items.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Whether so many of `num_all` differences are significant without any cause, the largest of them
// by `largest_sigmas`.
bool IsByChance(int num_significant, int num_all, double largest_sigmas) {
  constexpr double kNeverByChance = 3.5;  // sigmas, which 1 of 2100 exceeds
  return num_significant <= std::ceil(kByChance * num_all) && largest_sigmas < kNeverByChance;
}

// The most informative difference for a sailmaker: camber, draft or twist, if one of them is
// significant.
const SectionDifference* ForTheFirstLine(const std::vector<const SectionDifference*>& significant) {
  for (const char* number : {"camber_percent", "twist_deg", "draft_position_percent"}) {
    for (const SectionDifference* difference : significant) {
      if (difference->number == number) return difference;
    }
  }
  return significant.empty() ? nullptr : significant.front();
}

// Names what differs significantly: a number of a section, otherwise the markers, otherwise a
// surface. Says that nothing differs only if none of them does.
std::string SignificanceClause(const std::vector<Comparison>& series) {
  const Comparison& comparison = series.front();
  const ShapeDeviation& deviation = comparison.deviation;
  const auto significant = SignificantOf(comparison.sections);
  if (const SectionDifference* first = ForTheFirstLine(significant)) {
    const bool is_by_chance = IsByChance(static_cast<int>(significant.size()),
                                         static_cast<int>(comparison.sections.differences.size()),
                                         std::abs(*significant.front()->significance));
    return fmt::format("; {} (significant{})", DifferenceText(*first, series),
                       is_by_chance ? ", as by chance" : "");
  }
  if (deviation.num_significant > 0) {
    double largest_sigmas = 0.0;
    for (const MarkerDeviation& marker : deviation.markers) {
      if (!marker.is_over_surface) continue;
      largest_sigmas = std::max(largest_sigmas, std::abs(marker.significance.value_or(0.0)));
    }
    const bool is_by_chance =
        IsByChance(deviation.num_significant, deviation.num_with_sigma, largest_sigmas);
    return fmt::format("; {} of {} markers differ significantly{}", deviation.num_significant,
                       deviation.num_with_sigma, is_by_chance ? ", as by chance" : "");
  }
  for (const DeflectionField& field : comparison.deflections.fields) {
    if (DiffersSignificantly(field)) return "; " + SurfaceText(field);
  }
  return deviation.num_with_sigma == 0 ? "" : "; no difference is significant";
}

std::string FirstLine(const ComparisonPageInput& input) {
  const Comparison& first = input.series.front();
  if (input.series.size() == 1) {
    if (const auto& doubt = first.deviation.doubt; doubt && doubt->is_bad) {
      return Capitalized(doubt->reason) + ".";
    }
    const char* what =
        first.IsAgainstDesign() ? "The shape differs from the design by" : "The shapes differ by";
    if (IsSame(first.deviation)) {
      return first.IsAgainstDesign() ? "The shape matches the design." : "The shapes are the same.";
    }
    return fmt::format("{} {:.3g} mm RMS{}.", what, kMmPerM * first.deviation.distance_m.rms,
                       SignificanceClause(input.series));
  }
  std::vector<std::string> shapes;
  for (const Comparison& comparison : input.series) {
    const double rms_mm = kMmPerM * comparison.deviation.distance_m.rms;
    const auto& doubt = comparison.deviation.doubt;
    if (doubt && doubt->is_bad) {
      shapes.push_back(comparison.name + " is of another object");
    } else if (IsSame(comparison.deviation)) {
      shapes.push_back(comparison.name + " none");
    } else {
      shapes.push_back(fmt::format("{} {:.3g} mm RMS", comparison.name, rms_mm));
    }
  }
  return fmt::format("Differences from {}: {}.", input.reference_name, fmt::join(shapes, ", "));
}

}  // namespace

std::string ComparisonTitle(const ComparisonPageInput& input) {
  const std::string what = input.series.size() == 1 ? input.series.front().name
                                                    : fmt::format("{} shapes", input.series.size());
  return fmt::format("{} against {}", what, input.reference_name);
}

std::string NumberName(const std::string& number) {
  std::string name = number.substr(0, number.rfind('_'));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string SectionName(const std::vector<Comparison>& series, const std::string& part,
                        const std::string& section) {
  for (const Comparison& comparison : series) {
    for (const Section& other : comparison.sections.of_reference.sections) {
      if (other.part != part) return part + " " + section;
    }
  }
  return section;
}

std::string NumberUnit(const std::string& number) {
  const std::string unit = number.substr(number.rfind('_') + 1);
  return unit == "percent" ? "%" : unit == "deg" ? "°" : unit;
}

ComparisonVerdict JudgeComparison(const ComparisonPageInput& input) {
  ComparisonVerdict verdict{FirstLine(input), {}, ""};
  for (const Comparison& comparison : input.series) {
    if (const auto& doubt = comparison.deviation.doubt; doubt && verdict.level != "bad") {
      verdict.level = doubt->is_bad ? "bad" : "check";
    }
    const std::string prefix = input.series.size() == 1 ? "" : comparison.name + ": ";
    AddComparisonItems(input.series, comparison, prefix, &verdict.items);
  }
  return verdict;
}

}  // namespace velamap
