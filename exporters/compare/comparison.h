// Everything that is compared between a shape and its reference, and what the files say about a
// series of shapes.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "exporters/compare/deflection_field.h"
#include "exporters/compare/section_comparison.h"
#include "exporters/compare/shape_deviation.h"
#include "exporters/compare/shape_surfaces.h"
#include "exporters/compare/surface_comparison.h"
#include "exporters/formats/metrics_report.h"

namespace velamap {

struct ComparisonOptions {
  AlignmentOptions alignment;
  EdgeOptions edge;
  GridOptions grid;
  std::string part;              // empty for all
  double surface_sigma_m = 0.0;  // of a surface as the reference, see CompareWithMesh()
  bool with_deflections = false;
};

struct Comparison {
  std::string name;         // of the shape
  bool has_layout = false;  // without one there are no sections, surfaces and deflections
  ShapeDeviation deviation;
  SectionComparison sections;
  SurfaceComparison surfaces;
  DeflectionReport deflections;

  bool IsAgainstDesign() const { return !deviation.scale.has_value(); }
};

// The shape that a series is compared with. Its surfaces are the same for all shapes of the series,
// and fitting them takes a fifth of the time of a comparison or more.
struct SeriesReference {
  // Implicit, so that a single comparison can pass the shape itself.
  SeriesReference(UncertainShape reference)
      : uncertain(std::move(reference)), surfaces(uncertain.shape) {}

  UncertainShape uncertain;
  ShapeSurfaces surfaces;
};

// Throw the errors of CompareWithShape() and CompareWithMesh().
Comparison Compare(const std::string& name, const UncertainShape& shape,
                   const SeriesReference& reference, const Layout& layout,
                   const ComparisonOptions& options);
Comparison Compare(const std::string& name, const UncertainShape& shape,
                   const MeshDistance& reference, const Layout& layout,
                   const ComparisonOptions& options);

// The figures of all shapes. Values below 1e-9 become 0, so that rounding errors do not show. For
// several shapes, the table `shapes` has a row for each, and every row of the other tables names
// its shape.
MetricsReport MakeComparisonReport(const std::vector<Comparison>& series);

// Names shapes by their paths: the file, or the folder that holds a folder `shape` or a shape.csv.
// Equal names are numbered.
std::vector<std::string> NamesOfShapes(const std::vector<std::string>& paths);

}  // namespace velamap
