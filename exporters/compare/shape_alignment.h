// Rigid alignment of a shape with its reference before a comparison. The scale is never fitted.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/base/ids.h"
#include "importer/base/statistics.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

enum class AlignmentMethod {
  kAuto,           // by the reference part if possible, otherwise best fit
  kReferencePart,  // by the markers of the layout's reference part, such as the hull
  kMarkers,        // by given markers
  kBestFit,        // by all common corners, or by all corners for a surface
  kNone,           // both frames are the same
};

// "auto", "reference_part", "markers", "best_fit", "none".
std::string AlignmentMethodName(AlignmentMethod method);
// Throws InputError naming `what` for any other name.
AlignmentMethod AlignmentMethodFromName(const std::string& name, const std::string& what);

// Parses marker ids and ranges of them, such as "120,125-130". Throws InputError naming `what`.
std::vector<int> MarkerIdsFromText(const std::string& text, const std::string& what);

struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::kAuto;
  std::vector<int> marker_ids;  // for kMarkers
  // Best fit to a surface: start only from the frames as they are, not from several poses.
  bool starts_as_is = false;
};

// An equation of the alignment: the distance of the corner from its target along `direction` is
// zero.
struct AlignmentEquation {
  CornerId corner;
  Eigen::Vector3d x_in_reference_m;  // of the aligned corner
  Eigen::Vector3d direction;         // unit
  double weight = 1.0;
};

struct Alignment {
  AlignmentMethod method = AlignmentMethod::kNone;
  std::string description;  // the corners of the alignment
  std::vector<std::string> notes;
  Rigid3 reference_from_shape;
  std::vector<AlignmentEquation> equations;  // empty for kNone
  Statistics residual_m;                     // distances of the used corners from their targets
};

// The alignment of kNone, to a shape as to a surface.
Alignment NoAlignment();

// Aligns a shape with a shape by least squares over their common corners. Throws DataError with
// fewer than three common corners or if they lie on one line, and InputError for kReferencePart
// without a reference part in the layout and for kMarkers without ids or with an id that one shape
// lacks.
Alignment AlignShapes(const MarkerShape& shape, const MarkerShape& reference, const Layout& layout,
                      const AlignmentOptions& options);

}  // namespace velamap
