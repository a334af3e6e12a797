// Whether two shapes can be of the same object. An alignment brings any two shapes as near to each
// other as they get, so their distances alone do not show this.

#pragma once

#include <optional>
#include <string>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

// A larger misfit means that the shapes are of different objects. No change of a sail's trim comes
// near this value.
inline constexpr double kMaxMisfit = 0.3;

// How much two shapes agree: the misfit of the common markers of one part after an alignment with
// scale.
struct ShapeLikeness {
  double scale = 1.0;       // shape / reference
  double distance_m = 0.0;  // left between the corners, root mean square, in the reference's metres
  // distance_m over the size of the reference, the root mean square distance of these corners from
  // their mean: 0 for the same shape, near 1 for shapes that have nothing in common, and about 0.15
  // between a sail on one tack and on the other.
  double misfit = 0.0;

  bool IsOfAnotherObject() const { return misfit > kMaxMisfit; }
};

// Measures the part that agrees best, because the other parts may have been trimmed. Parts are
// those of `layout` or, without markers there, those of the shape; with fewer than three whole
// markers in common in each of them, all markers are one part. Returns nothing if these are fewer
// than three, too.
std::optional<ShapeLikeness> MeasureLikeness(const MarkerShape& shape, const MarkerShape& reference,
                                             const Layout& layout);

// A reason to doubt a comparison, with the remedy.
struct ComparisonDoubt {
  bool is_bad = false;  // otherwise something to check
  std::string reason;   // begins with a small letter, no full stop
};

// Bad if the shapes are not of the same object; to check if their sizes differ by more than 5 %.
std::optional<ComparisonDoubt> DoubtOf(const ShapeLikeness& likeness);

// The same for a shape fitted to a surface, over which `num_over_surface` of `num_markers` lie, at
// a root mean square distance of `distance_m`.
std::optional<ComparisonDoubt> DoubtOfSurfaceFit(const MarkerShape& shape, double distance_m,
                                                 int num_over_surface, int num_markers);

// Whether a length is 1000 times another one, within 7 %: millimetres that were taken for metres.
bool IsThousandfold(double ratio);

}  // namespace velamap
