#include "exporters/comparison_page/comparison_words.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kByChance = 0.0455;  // beyond two sigmas
constexpr double kSame_m = 1e-6;
constexpr std::size_t kMaxNamed = 4;

// Whether so many of `num_all` differences are significant without any cause, the largest of them
// by `largest_sigmas`.
bool IsByChance(int num_significant, int num_all, double largest_sigmas) {
  constexpr double kNeverByChance = 3.5;  // sigmas, which 1 of 2100 exceeds
  return num_significant <= std::ceil(kByChance * num_all) && largest_sigmas < kNeverByChance;
}

std::string Capitalized(std::string text) {
  text[0] = static_cast<char>(std::toupper(text[0]));
  return text;
}

bool IsSame(const ShapeDeviation& deviation) {
  return deviation.distance_m.MaxAbs() < kSame_m && deviation.difference_m.MaxAbs() < kSame_m;
}

// The significant differences of section numbers, the most significant first.
std::vector<const SectionDifference*> SignificantOf(const SectionComparison& sections) {
  std::vector<const SectionDifference*> significant;
  for (const SectionDifference& difference : sections.differences) {
    if (difference.IsSignificant()) significant.push_back(&difference);
  }
  std::stable_sort(significant.begin(), significant.end(), [](const auto* a, const auto* b) {
    return std::abs(*a->significance) > std::abs(*b->significance);
  });
  return significant;
}

// The difference that tells a sailmaker most: camber, draft or twist, where one of them is
// significant.
const SectionDifference* ForTheFirstLine(const std::vector<const SectionDifference*>& significant) {
  for (const char* number : {"camber_percent", "twist_deg", "draft_position_percent"}) {
    for (const SectionDifference* difference : significant) {
      if (difference->number == number) return difference;
    }
  }
  return significant.empty() ? nullptr : significant.front();
}

std::string Text(const SectionDifference& d, const std::vector<Comparison>& series) {
  const std::string unit = NumberUnit(d.number);
  return fmt::format("{} of {} {:+.{}f}{}{}", NumberName(d.number),
                     SectionName(series, d.part, d.section), d.Difference(), unit == "%" ? 2 : 1,
                     unit == "°" ? "" : " ", unit);
}

// The points of a surface with a sigma, and those that differ significantly.
struct SurfacePoints {
  int num_known = 0, num_significant = 0;
};

SurfacePoints PointsOf(const DeflectionField& field) {
  SurfacePoints points;
  for (const auto& deflection : field.deflections) {
    if (!deflection || !deflection->sigma_m) continue;
    ++points.num_known;
    points.num_significant += deflection->IsSignificant() ? 1 : 0;
  }
  return points;
}

std::string SurfaceText(const DeflectionField& field) {
  const SurfacePoints points = PointsOf(field);
  const double percent = 100.0 * points.num_significant / points.num_known;
  return fmt::format("the surface of {} differs significantly at {} % of its points", field.part,
                     percent < 1 ? "less than 1" : fmt::format("{:.0f}", percent));
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
    return fmt::format("; {} (significant{})", Text(*first, series),
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
    if (PointsOf(field).num_significant > 0) return "; " + SurfaceText(field);
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

// Adds the items of one shape, each after `prefix`.
class Items {
 public:
  Items(const std::vector<Comparison>& series, const Comparison& comparison, std::string prefix,
        std::vector<std::string>* items)
      : series_(series),
        comparison_(comparison),
        deviation_(comparison.deviation),
        prefix_(std::move(prefix)),
        items_(items) {}

  void AddAll() {
    AddDoubt();
    AddMarkers();
    AddSections();
    AddSurface();
    AddEdge();
    AddScale();
    AddNotes();
  }

 private:
  void Add(const std::string& text) {
    items_->push_back(prefix_.empty() ? Capitalized(text) : prefix_ + text);
  }

  // The first line says what is bad about a single shape.
  void AddDoubt() {
    if (!deviation_.doubt || (deviation_.doubt->is_bad && series_.size() == 1)) return;
    Add(deviation_.doubt->reason);
  }

  void AddMarkers() {
    if (IsSame(deviation_)) return;
    const auto is_known = [](const MarkerDeviation& marker) { return marker.is_over_surface; };
    const auto largest = std::max_element(
        deviation_.markers.begin(), deviation_.markers.end(), [&](const auto& a, const auto& b) {
          return is_known(a) * std::abs(a.distance_m) < is_known(b) * std::abs(b.distance_m);
        });
    const std::string farthest = fmt::format("farthest is marker {}, {:+.1f} mm",
                                             largest->marker_id, kMmPerM * largest->distance_m);
    if (deviation_.num_with_sigma == 0) {
      return Add(farthest + "; no sigmas are known, so nothing can be called significant");
    }
    Add(
        fmt::format("{} of {} markers differ significantly, by more than 2 sigmas; about {:.0f} "
                    "would be expected by chance; {}",
                    deviation_.num_significant, deviation_.num_with_sigma,
                    kByChance * deviation_.num_with_sigma, farthest));
  }

  void AddSections() {
    const auto significant = SignificantOf(comparison_.sections);
    const std::size_t num_all = comparison_.sections.differences.size();
    if (significant.empty()) {
      if (num_all > 0 && deviation_.num_with_sigma > 0 && !IsSame(deviation_)) {
        Add(fmt::format("none of the {} numbers of the sections differs significantly", num_all));
      }
      return;
    }
    std::vector<std::string> names;
    for (const SectionDifference* difference : significant) {
      if (names.size() < kMaxNamed) names.push_back(Text(*difference, series_));
    }
    Add(
        fmt::format("{} of {} numbers of the sections differ significantly; about {:.0f} would be "
                    "expected by chance: {}{}",
                    significant.size(), num_all, kByChance * static_cast<double>(num_all),
                    fmt::join(names, ", "), significant.size() > kMaxNamed ? " …" : ""));
  }

  void AddSurface() {
    for (const DeflectionField& field : comparison_.deflections.fields) {
      if (PointsOf(field).num_significant == 0) continue;
      Add(fmt::format("{}; about {:.0f} % would be expected by chance, neighbours together",
                      SurfaceText(field), 100.0 * kByChance));
    }
  }

  void AddEdge() {
    if (deviation_.surface_sigma_m > 0) {
      Add(fmt::format(
          "the sigmas include {:.2g} mm for the reference, because the markers that this "
          "surface was fitted to lie off it by as much",
          kMmPerM * deviation_.surface_sigma_m));
    }
    if (deviation_.num_beyond_edge > 0) {
      Add(
          fmt::format("{} markers lie a little beyond the edge of the design; their distance is "
                      "measured along its normal there",
                      deviation_.num_beyond_edge));
    }
    const std::vector<int> beside = MarkersBeside(deviation_);
    if (beside.empty()) return;
    Add(fmt::format("beside the design, and without a distance: marker{} {}",
                    beside.size() == 1 ? "" : "s", fmt::join(beside, " ")));
  }

  void AddScale() {
    if (!deviation_.scale || std::abs(*deviation_.scale - 1) < 5e-6) return;
    if (deviation_.doubt) return;  // which is about the size, or leaves none to compare
    Add(fmt::format(
        "the shape is {:.3f} % {} than the reference; the alignment does not change this",
        100 * std::abs(*deviation_.scale - 1), *deviation_.scale > 1 ? "larger" : "smaller"));
  }

  void AddNotes() {
    for (const auto* notes : {&deviation_.alignment.notes, &comparison_.sections.notes,
                              &comparison_.surfaces.notes, &comparison_.deflections.notes}) {
      for (const std::string& note : *notes) {
        if (!note.empty()) items_->push_back(prefix_ + note);  // may begin with the name of a part
      }
    }
  }

  const std::vector<Comparison>& series_;
  const Comparison& comparison_;
  const ShapeDeviation& deviation_;
  const std::string prefix_;
  std::vector<std::string>* items_;
};

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
    Items(input.series, comparison, prefix, &verdict.items).AddAll();
  }
  return verdict;
}

}  // namespace velamap
