#include "exporters/comparison_page/comparison_items.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/comparison_page/comparison_words.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kSame_m = 1e-6;
constexpr std::size_t kMaxNamed = 4;

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

// Adds the items of one shape, each after `prefix`.
class ComparisonItems {
 public:
  ComparisonItems(const std::vector<Comparison>& series, const Comparison& comparison,
                  std::string prefix, std::vector<std::string>* items)
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
      if (names.size() < kMaxNamed) names.push_back(DifferenceText(*difference, series_));
    }
    Add(
        fmt::format("{} of {} numbers of the sections differ significantly; about {:.0f} would be "
                    "expected by chance: {}{}",
                    significant.size(), num_all, kByChance * static_cast<double>(num_all),
                    fmt::join(names, ", "), significant.size() > kMaxNamed ? " …" : ""));
  }

  void AddSurface() {
    for (const DeflectionField& field : comparison_.deflections.fields) {
      if (!DiffersSignificantly(field)) continue;
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

std::string Capitalized(std::string text) {
  text[0] = static_cast<char>(std::toupper(text[0]));
  return text;
}

bool IsSame(const ShapeDeviation& deviation) {
  return deviation.distance_m.MaxAbs() < kSame_m && deviation.difference_m.MaxAbs() < kSame_m;
}

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

std::string DifferenceText(const SectionDifference& d, const std::vector<Comparison>& series) {
  const std::string unit = NumberUnit(d.number);
  return fmt::format("{} of {} {:+.{}f}{}{}", NumberName(d.number),
                     SectionName(series, d.part, d.section), d.Difference(), unit == "%" ? 2 : 1,
                     unit == "°" ? "" : " ", unit);
}

bool DiffersSignificantly(const DeflectionField& field) {
  return PointsOf(field).num_significant > 0;
}

std::string SurfaceText(const DeflectionField& field) {
  const SurfacePoints points = PointsOf(field);
  const double percent = 100.0 * points.num_significant / points.num_known;
  return fmt::format("the surface of {} differs significantly at {} % of its points", field.part,
                     percent < 1 ? "less than 1" : fmt::format("{:.0f}", percent));
}

void AddComparisonItems(const std::vector<Comparison>& series, const Comparison& comparison,
                        const std::string& prefix, std::vector<std::string>* items) {
  ComparisonItems(series, comparison, prefix, items).AddAll();
}

}  // namespace velamap
