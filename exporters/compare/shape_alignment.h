// How a shape is laid onto its reference before the two are compared. Rigid: scale is never fitted.

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
  kAuto,           // the reference part where it can be done, else best fit
  kReferencePart,  // by the markers of the layout's reference part, such as the hull
  kMarkers,        // by markers that are named
  kBestFit,        // by all common corners; onto a surface: by all corners
  kNone,           // the frames of both are the same
};

// "auto", "reference_part", "markers", "best_fit", "none".
const char* AlignmentMethodName(AlignmentMethod method);
// Throws InputError that names `what` for any other name.
AlignmentMethod AlignmentMethodFromName(const std::string& name, const std::string& what);

// Ids that commas separate, such as "120,121". Throws InputError that names `what`.
std::vector<int> MarkerIdsFromText(const std::string& text, const std::string& what);

struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::kAuto;
  std::vector<int> marker_ids;  // for kMarkers
  // Best fit onto a surface: starts from the frames as they are only, not from several poses.
  bool starts_as_is = false;
};

// A residual that the alignment made small: how far the corner is from its place along `direction`.
struct AlignmentEquation {
  CornerId corner;
  Eigen::Vector3d x_in_reference_m;  // of the aligned corner
  Eigen::Vector3d direction;         // unit
  double weight = 1.0;
};

struct Alignment {
  AlignmentMethod method = AlignmentMethod::kNone;
  std::string description;  // what it was made of
  std::vector<std::string> notes;
  Rigid3 reference_from_shape;
  std::vector<AlignmentEquation> equations;  // none for kNone
  Statistics residual_m;  // of the corners it was made of: distances to their places
};

// Shape onto shape, by least squares over the corners that both have. Throws DataError with fewer
// than three common corners or when they lie on one line; InputError for kReferencePart without a
// reference part in the layout, for kMarkers without ids or with one that is not in both.
Alignment AlignShapes(const MarkerShape& shape, const MarkerShape& reference, const Layout& layout,
                      const AlignmentOptions& options);

// The same corners of both, in the same order.
struct CommonCorners {
  std::vector<CornerId> ids;
  std::vector<Eigen::Vector3d> x_in_shape_m;
  std::vector<Eigen::Vector3d> x_in_reference_m;
};
// Of these markers; of all for an empty list.
CommonCorners FindCommonCorners(const MarkerShape& shape, const MarkerShape& reference,
                                const std::vector<int>& marker_ids = {});

}  // namespace velamap
