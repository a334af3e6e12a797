#include "exporters/shape/part_planes.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/geometry/units.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

// A 3x3 grid of markers of 2 cm on one face of a box, outward normal along `axis`.
void AddFace(const std::string& part, const Eigen::Quaterniond& rotation, double distance_m,
             int first_id, MarkerShape* shape) {
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d center(0.04 * (i % 3 - 1), 0.04 * (i / 3 - 1), distance_m);
    ShapeMarker marker;
    marker.marker_id = first_id + i;
    marker.part = part;
    const std::array<Eigen::Vector3d, 5> offsets = {
        {{0, 0, 0}, {-0.01, 0.01, 0}, {0.01, 0.01, 0}, {0.01, -0.01, 0}, {-0.01, -0.01, 0}}};
    for (std::size_t corner = 0; corner < 5; ++corner) {
      marker.x_in_shape_m[corner] = rotation * (center + offsets[corner]);
    }
    shape->markers.push_back(marker);
  }
}

MarkerShape Box() {
  MarkerShape shape;
  AddFace("front", Eigen::Quaterniond::Identity(), 0.1, 0, &shape);
  AddFace("back", Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())), 0.1, 10,
          &shape);
  AddFace("side", Eigen::Quaterniond(Eigen::AngleAxisd(1.57079632679490, Eigen::Vector3d::UnitY())),
          0.1, 20, &shape);
  return shape;
}

TEST(PartPlanes, ExactBoxHasFlatFacesAtRightAngles) {
  const auto planes = FitPartPlanes(Box());
  ASSERT_EQ(planes.size(), 3u);
  for (const PartPlane& plane : planes) {
    EXPECT_EQ(plane.num_markers, 9);
    EXPECT_EQ(plane.corner_distance_mm.count, 36);
    EXPECT_EQ(plane.center_distance_mm.count, 9);
    EXPECT_LT(plane.corner_distance_mm.max, 1e-10);
    EXPECT_LT(plane.center_distance_mm.max, 1e-10);
    EXPECT_LT(plane.normal_spread_deg.max, 1e-10);
    EXPECT_LT(plane.tangent_spread_deg.max, 1e-10);
  }
  const auto pairs = ComparePlanes(planes);  // back-front, back-side, front-side
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_NEAR(pairs[0].angle_deg, 180, 1e-10);
  EXPECT_NEAR(pairs[0].distance_mm, 200, 1e-9);
  EXPECT_NEAR(pairs[1].angle_deg, 90, 1e-9);
  EXPECT_EQ(pairs[2].distance_mm, 0);
}

TEST(PartPlanes, ResidualIsTheDistanceFromThePlane) {
  MarkerShape shape = Box();
  // Lifting opposite corners of the middle marker keeps the plane and gives four residuals.
  for (std::size_t corner = 1; corner <= 4; ++corner) {
    *shape.markers[4].x_in_shape_m[corner] += Eigen::Vector3d(0, 0, corner % 2 ? 1e-3 : -1e-3);
  }
  const auto planes = FitPartPlanes(shape);
  EXPECT_EQ(planes[1].part, "front");
  EXPECT_NEAR(planes[1].corner_distance_mm.max, 1.0, 1e-6);
  EXPECT_NEAR(planes[1].corner_distance_mm.rms, std::sqrt(4.0 / 36), 1e-6);
  EXPECT_LT(planes[1].center_distance_mm.max, 1e-10);  // the centre stays where it is
}

TEST(PartPlanes, MarkersThatAreNotWholeTakeNoPart) {
  MarkerShape shape = Box();
  for (std::size_t i = 1; i < 9; ++i) shape.markers[i].x_in_shape_m[0].reset();
  EXPECT_EQ(FitPartPlanes(shape).size(), 2u);
}

TEST(PartPlanes, PlaneErrorIsTheDistanceOfTheCentersWithoutSign) {
  MarkerShape shape;
  for (int i = 0; i < 4; ++i) {  // a square saddle: its plane is z = 0
    const double x = i % 2 == 0 ? -0.1 : 0.1, y = i / 2 == 0 ? -0.1 : 0.1;
    shape.markers.push_back(
        SquareMarker(i, 0.02, {Eigen::Quaterniond::Identity(), {x, y, 20.0 * x * y * 0.01}}));
  }
  const Statistics distance_mm = FitPartPlanes(shape).at(0).center_distance_mm;
  EXPECT_EQ(distance_mm.count, 4);
  EXPECT_NEAR(distance_mm.min, 2.0, 1e-9);
  EXPECT_NEAR(distance_mm.max, 2.0, 1e-9);
  shape.markers.pop_back();  // three points always lie in a plane
  EXPECT_EQ(FitPartPlanes(shape).at(0).center_distance_mm.count, 0);
  EXPECT_EQ(FitPartPlanes(shape).at(0).corner_distance_mm.count, 12);
}

// Two markers tilted by a degrees to either side of their mean.
PartPlane Leaning(double angle_deg, const Eigen::Vector3d& axis) {
  MarkerShape shape;
  for (const int sign : {-1, 1}) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(sign * angle_deg * kRadPerDeg, axis));
    const Eigen::Quaterniond odd(0.8, 0.3, -0.4, 0.1);
    shape.markers.push_back(
        SquareMarker(sign + 1, 0.05, {odd.normalized() * turn, {0.2 * sign, 1, 3}}));
  }
  return FitPartPlanes(shape).at(0);
}

TEST(PartPlanes, SpreadsAreTheAnglesToTheMeanDirection) {
  const PartPlane turned_in_plane = Leaning(3.0, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(turned_in_plane.tangent_spread_deg.min, 3.0, 1e-9);
  EXPECT_NEAR(turned_in_plane.tangent_spread_deg.max, 3.0, 1e-9);
  EXPECT_LT(turned_in_plane.normal_spread_deg.max, 1e-9);
  const PartPlane about_x = Leaning(1e-6, Eigen::Vector3d::UnitX());  // small angles stay exact
  EXPECT_NEAR(about_x.normal_spread_deg.mean, 1e-6, 1e-12);
  EXPECT_LT(about_x.tangent_spread_deg.max, 1e-12);
  const PartPlane about_y = Leaning(20.0, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(about_y.normal_spread_deg.mean, 20.0, 1e-9);
  EXPECT_NEAR(about_y.tangent_spread_deg.mean, 20.0, 1e-9);
}

// Corners of a box as a model, so that they can have a covariance.
Model BoxModel(const MarkerShape& box) {
  Model model;
  for (const ShapeMarker& marker : box.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      model.points3D[Point3DIdFromCorner({marker.marker_id, corner})].x_in_world =
          *marker.x_in_shape_m[corner];
    }
  }
  return model;
}

// A box with uneven faces; the back one is tilted by 3 degrees.
MarkerShape CrookedBox() {
  MarkerShape shape;
  AddFace("front", Eigen::Quaterniond::Identity(), 0.1, 0, &shape);
  AddFace("back",
          Eigen::Quaterniond(Eigen::AngleAxisd(3.09, Eigen::Vector3d(1, 0.2, 0).normalized())), 0.1,
          10, &shape);
  AddFace("side", Eigen::Quaterniond(Eigen::AngleAxisd(1.4, Eigen::Vector3d::UnitY())), 0.1, 20,
          &shape);
  std::mt19937 random(4);
  for (ShapeMarker& marker : shape.markers) {
    marker.x_in_shape_m[0]->setZero();
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      for (double& x : *marker.x_in_shape_m[corner]) x += 2e-3 * (random() / 4294967295.0 - 0.5);
      *marker.x_in_shape_m[0] += *marker.x_in_shape_m[corner] / kNumCorners;
    }
  }
  return shape;
}

TEST(PartPlanes, SigmasAreTheStandardDeviationsOfWhatIsReported) {
  const MarkerShape box = CrookedBox();
  const PointCovariance covariance = ExampleCovariance(BoxModel(box), 1e-4, 8);
  const auto pairs = ComparePlanes(FitPartPlanes(box, &covariance), &covariance);
  ASSERT_EQ(pairs.size(), 3u);
  std::vector<std::vector<double>> angles_deg(3), distances_mm(3);
  SampleShapes(box, covariance, 2000, [&](const MarkerShape& sample) {
    const auto sampled = ComparePlanes(FitPartPlanes(sample));
    for (std::size_t i = 0; i < 3; ++i) {
      angles_deg[i].push_back(sampled[i].angle_deg);
      distances_mm[i].push_back(sampled[i].distance_mm);
    }
  });
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(*pairs[i].angle_sigma_deg / ComputeStatistics(angles_deg[i]).standard_deviation,
                1.0, 0.07)
        << i;
  }
  ASSERT_TRUE(pairs[0].distance_sigma_mm.has_value());  // back and front
  EXPECT_NEAR(*pairs[0].distance_sigma_mm / ComputeStatistics(distances_mm[0]).standard_deviation,
              1.0, 0.07);
  EXPECT_FALSE(pairs[1].distance_sigma_mm.has_value());
}

TEST(PartPlanes, PlaneErrorSigmaIsWhatNoiseMakesOfAFlatPart) {
  const MarkerShape box = Box();
  const PointCovariance covariance = ExampleCovariance(BoxModel(box), 1e-4, 9);
  const auto planes = FitPartPlanes(box, &covariance);
  double sum_mm2 = 0.0;
  constexpr int kNumSamples = 2000;
  SampleShapes(box, covariance, kNumSamples, [&](const MarkerShape& sample) {
    const double rms_mm = FitPartPlanes(sample)[1].center_distance_mm.rms;
    sum_mm2 += rms_mm * rms_mm / kNumSamples;
  });
  EXPECT_NEAR(*planes[1].center_distance_sigma_mm / std::sqrt(sum_mm2), 1.0, 0.04);
  EXPECT_FALSE(FitPartPlanes(box)[1].center_distance_sigma_mm.has_value());
}

TEST(PartPlanes, ARigidMoveIsNoUncertaintyOfAngles) {
  const MarkerShape box = CrookedBox();
  PointCovariance covariance = ExampleCovariance(BoxModel(box), 1e-4, 8);
  for (Eigen::MatrixXd& block : covariance.blocks) block.setZero();
  const Model model = BoxModel(box);
  covariance.signs.setOnes();
  for (int axis = 0; axis < 3; ++axis) {  // turns about the three axes by 0.01 rad
    for (std::size_t i = 0; i < covariance.point3D_ids.size(); ++i) {
      covariance.factor.col(axis).segment<3>(3 * static_cast<int>(i)) =
          0.01 * Eigen::Vector3d::Unit(axis).cross(
                     model.points3D.at(covariance.point3D_ids[i]).x_in_world);
    }
  }
  for (const PlanePair& pair : ComparePlanes(FitPartPlanes(box, &covariance), &covariance)) {
    EXPECT_LT(*pair.angle_sigma_deg, 1e-6);
    EXPECT_LT(pair.distance_sigma_mm.value_or(0.0), 1e-6);
  }
}

TEST(PartPlanes, ParallelPlanesHaveAnAngleSigmaToo) {
  const MarkerShape box = Box();
  const PointCovariance covariance = ExampleCovariance(BoxModel(box), 1e-4, 9);
  const auto pairs = ComparePlanes(FitPartPlanes(box, &covariance), &covariance);
  EXPECT_NEAR(pairs[0].angle_deg, 180.0, 1e-9);
  EXPECT_GT(*pairs[0].angle_sigma_deg, 1e-3);
  EXPECT_LT(*pairs[0].angle_sigma_deg, 1.0);
}

}  // namespace
}  // namespace velamap
