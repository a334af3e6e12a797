// Writes spline surfaces as STEP (AP214) and IGES (5.3) with Open CASCADE. Coordinates and header
// are in mm. The surface becomes one face with its poles and knots, without approximation. The date
// in the header is OutputDate() (importer/text/output_date.h): where SOURCE_DATE_EPOCH sets it, the
// same surface gives the same bytes.
//
// Calls are serialized, because Open CASCADE keeps its settings in global variables.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/surface_spline.h"

namespace velamap {

// A B-spline with multiplicities in its knots, as SplineSurface has them.
struct CadCurve {
  std::string name;
  int degree = 3;
  Eigen::ArrayXd knots;
  Eigen::Matrix3Xd poles_in_shape_m;
};

struct CadPoint {
  std::string name;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
};

// What lies beside the surface.
struct CadExtras {
  std::vector<CadCurve> curves;
  std::vector<CadPoint> points;
  std::string iges_file_name{};  // of the header; empty: the name with .igs
};

// `name`, the name of the part, becomes the name of the product in STEP and of the surface in IGES.
// Curves and points keep their names. STEP has them in a second product, which needs a curve.
// Throws std::logic_error if Open CASCADE fails.
void WriteStep(const SplineSurface& surface, const std::string& name, std::ostream& out,
               const CadExtras& extras = {});
void WriteIges(const SplineSurface& surface, const std::string& name, std::ostream& out,
               const CadExtras& extras = {});

}  // namespace velamap
