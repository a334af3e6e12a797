#include "reconstruct/model/weak_geometry.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/principal_axes.h"
#include "importer/geometry/symmetric_eigen.h"
#include "importer/geometry/units.h"
#include "reconstruct/geometry/covariance_update.h"

namespace velamap {
namespace {

// Geometry is weak where the points' ellipsoids are more elongated than this and the parallax is
// small. Elongation alone is no proof: the sizes of the markers also elongate ellipsoids where
// corners are precise and prints are not.
constexpr double kMaxElongation = 10.0;

constexpr double kMaxWeakParallax = 20.0 * kRadPerDeg;

// Joins the cause to the consequence in every warning.
constexpr char kTherefore[] = "; therefore the points are known to ";

// Medians over the 1-sigma ellipsoids of the points.
struct Ellipsoid {
  double longest_m = 0.0;   // half-axis
  double shortest_m = 0.0;  // half-axis
  double elongation = 1.0;  // longest / shortest
};

Ellipsoid MedianEllipsoid(const PointCovariance& points) {
  std::vector<double> longest_m, shortest_m, elongations;
  for (const Point3DId point3D_id : points.point3D_ids) {
    const Eigen::Vector3d variances =
        DecomposeSymmetric(PointCovarianceOf(points, point3D_id)).values.cwiseMax(1e-30);
    shortest_m.push_back(std::sqrt(variances[0]));
    longest_m.push_back(std::sqrt(variances[2]));
    elongations.push_back(std::sqrt(variances[2] / variances[0]));
  }
  return {Median(std::move(longest_m)), Median(std::move(shortest_m)),
          Median(std::move(elongations))};
}

// The covariance for a known common scale. An unknown scale makes every ellipsoid longer towards
// the middle of the object, which says nothing about lines of sight.
PointCovariance WithoutScale(const Model& model, const PointCovariance& points) {
  std::vector<Eigen::Vector3d> x_in_world;
  for (const Point3DId point3D_id : points.point3D_ids) {
    x_in_world.push_back(model.points3D.at(point3D_id).x_in_world);
  }
  PointCovariance result = points;
  AddMeasurements(ScaleGradient(x_in_world), Eigen::VectorXd::Zero(1), &result);
  return result;
}

// Geometry of the cameras and points.
struct Views {
  std::vector<Eigen::Vector3d> camera_centers;  // in the order of the images
  double camera_extent_m = 0.0;                 // largest distance between two cameras
  double distance_m = 0.0;       // median distance of a camera from the centroid of the points
  double parallax_rad = 0.0;     // median over the points of the largest angle between two views
  double object_extent_m = 0.0;  // RMS distance of the points from their centroid
  bool is_flat = false;
  double max_tilt_rad = 0.0;  // largest angle between a view and the normal of a flat object
};

// The largest angle between two cameras as seen from a point.
double LargestParallax(const Eigen::Vector3d& x, const std::vector<Eigen::Vector3d>& cameras) {
  double parallax = 0.0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      parallax = std::max(parallax, AngleBetween(cameras[i] - x, cameras[j] - x));
    }
  }
  return parallax;
}

// The median over the points of the largest angle between two images that see a point.
double MedianParallax(const Model& model, const std::vector<Eigen::Vector3d>& camera_centers) {
  std::map<ImageId, std::size_t> image_idxs;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    image_idxs[model.images[i].image_id] = i;
  }
  std::vector<double> parallaxes;
  for (const auto& [point3D_id, point] : model.points3D) {
    std::vector<Eigen::Vector3d> seeing;
    for (const TrackElement& element : point.track) {
      seeing.push_back(camera_centers[image_idxs.at(element.image_id)]);
    }
    parallaxes.push_back(LargestParallax(point.x_in_world, seeing));
  }
  return Median(std::move(parallaxes));
}

// The same if every image saw every point.
double MedianParallaxOfAll(const Model& model, const std::vector<Eigen::Vector3d>& camera_centers) {
  std::vector<double> parallaxes;
  for (const auto& [point3D_id, point] : model.points3D) {
    parallaxes.push_back(LargestParallax(point.x_in_world, camera_centers));
  }
  return Median(std::move(parallaxes));
}

Views DescribeViews(const Model& model) {
  constexpr double kFlat = 0.02;  // thickness over extent
  std::vector<Eigen::Vector3d> centers;
  for (const ModelImage& image : model.images) {
    centers.push_back(Inverse(image.cam_from_world).translation);
  }
  std::vector<Eigen::Vector3d> points;
  for (const auto& [point3D_id, point] : model.points3D) points.push_back(point.x_in_world);
  const PrincipalAxes axes = ComputePrincipalAxes(points);
  const Eigen::Vector3d variances = axes.sums_of_squares / static_cast<double>(points.size());
  Views views;
  views.object_extent_m = std::sqrt(variances.sum());
  views.is_flat = std::sqrt(std::max(0.0, variances[0])) < kFlat * views.object_extent_m;
  std::vector<double> distances_m;
  for (const Eigen::Vector3d& center : centers) {
    distances_m.push_back((center - axes.mean).norm());
    const double angle = AngleBetween(center - axes.mean, axes.directions.col(0));
    views.max_tilt_rad = std::max(views.max_tilt_rad, std::min(angle, kPi - angle));
    for (const Eigen::Vector3d& other : centers) {
      views.camera_extent_m = std::max(views.camera_extent_m, (center - other).norm());
    }
  }
  views.distance_m = Median(std::move(distances_m));
  views.parallax_rad = MedianParallax(model, centers);
  views.camera_centers = std::move(centers);
  return views;
}

struct Explanation {
  std::string cause, remedy;
};

Explanation Explain(const Model& model, const Views& views) {
  constexpr double kOnePlace = 0.02;
  constexpr double kHeadOn = 20.0 * kRadPerDeg;
  const std::string move = "take images from places more than 30 degrees apart";
  if (views.camera_extent_m < kOnePlace * views.distance_m) {
    return {fmt::format(
                "all images are taken from one place (within {:.2g} m, at a distance of {:.2g} m): "
                "the camera turned, but hardly moved",
                views.camera_extent_m, views.distance_m),
            move};
  }
  if (views.is_flat && views.max_tilt_rad < kHeadOn) {
    return {fmt::format("a flat object is seen head-on in all images (within {:.0f} degrees of its "
                        "normal)",
                        kDegPerRad * views.max_tilt_rad),
            move};
  }
  const std::string within =
      fmt::format("half of the points are seen within less than {:.1f} degrees",
                  kDegPerRad * views.parallax_rad);
  const double around_rad = MedianParallaxOfAll(model, views.camera_centers);
  if (around_rad > kMaxWeakParallax) {  // the camera moved enough
    return {fmt::format("{}, although the camera moved by {:.0f} degrees around them: most images "
                        "do not show their markers, or not clearly enough",
                        within, kDegPerRad * around_rad),
            "keep all markers in the picture and make them larger or sharper in it (go closer, "
            "shorten the shutter, avoid glare)"};
  }
  return {"there is hardly any parallax: " + within, move};
}

}  // namespace

std::string FindWeakGeometry(const Model& model, const PointCovariance& points) {
  // If points are more uncertain than this fraction of the object's extent, there is no shape.
  constexpr double kMaxRelativeSigma = 0.2;
  if (points.IsEmpty()) return {};
  const Ellipsoid ellipsoid = MedianEllipsoid(WithoutScale(model, points));
  if (ellipsoid.elongation < kMaxElongation) return {};
  const Views views = DescribeViews(model);
  if (views.parallax_rad > kMaxWeakParallax) return {};
  const Explanation explanation = Explain(model, views);
  const std::string text =
      fmt::format("{}{}{:.2g} mm along the line of sight, but to {:.2g} mm across it: {}",
                  explanation.cause, kTherefore, kMmPerM * ellipsoid.longest_m,
                  kMmPerM * ellipsoid.shortest_m, explanation.remedy);
  if (ellipsoid.longest_m > kMaxRelativeSigma * views.object_extent_m) {
    throw DataError("the images leave the shape undetermined: " + text);
  }
  return text;
}

bool IsWeakGeometryWarning(const std::string& warning) {
  return warning.find(kTherefore) != std::string::npos;
}

}  // namespace velamap
