#include "tests/tools/filling_methods.h"

#include <Eigen/Geometry>
#include <ElSLib.hxx>
#include <GeomPlate_BuildPlateSurface.hxx>
#include <GeomPlate_PointConstraint.hxx>
#include <GeomPlate_Surface.hxx>
#include <Geom_Plane.hxx>
#include <gp_Ax3.hxx>

#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

// The plate is a displacement of a plane, so that only graphs above it are possible. It goes
// through the points.
FillingOffsets ByOpenCascade(const FillingTask& task) {
  std::vector<Eigen::Vector3d> corners_m;
  for (const FreeformMarker& marker : task.markers) {
    corners_m.insert(corners_m.end(), marker.corners_in_shape_m.begin(),
                     marker.corners_in_shape_m.end());
  }
  const auto axes = ComputePrincipalAxes(corners_m);
  const Eigen::Vector3d normal = axes.directions.col(0), along = axes.directions.col(2);
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : corners_m) {
    center_m += x / static_cast<double>(corners_m.size());
  }
  const gp_Ax3 frame(gp_Pnt(center_m.x(), center_m.y(), center_m.z()),
                     gp_Dir(normal.x(), normal.y(), normal.z()),
                     gp_Dir(along.x(), along.y(), along.z()));
  GeomPlate_BuildPlateSurface plate;
  plate.LoadInitSurface(new Geom_Plane(frame));
  for (const Eigen::Vector3d& x : corners_m) {
    plate.Add(new GeomPlate_PointConstraint(gp_Pnt(x.x(), x.y(), x.z()), 0, 1e-6));
  }
  plate.Perform();
  FillingOffsets offsets_m(task.places_m.size());
  if (!plate.IsDone()) return offsets_m;
  for (std::size_t i = 0; i < offsets_m.size(); ++i) {
    const Eigen::Vector3d& x = task.places_m[i];
    double u = 0.0, v = 0.0;
    ElSLib::Parameters(gp_Pln(frame), gp_Pnt(x.x(), x.y(), x.z()), u, v);
    const gp_Pnt found = plate.Surface()->Value(u, v);
    offsets_m[i] = task.normals[i].dot(Eigen::Vector3d(found.X(), found.Y(), found.Z()) - x);
  }
  return offsets_m;
}

}  // namespace

void AddOpenCascadeMethods(std::vector<FillingMethod>* methods) {
  methods->push_back({"Open CASCADE plate", false, ByOpenCascade});
}

}  // namespace velamap
