#include "exporters/scale/marker_sides.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "exporters/scale/metric_shape.h"
#include "importer/base/statistics.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

void AddNormalNoise(double sigma_px, std::mt19937* random, Model* model) {
  std::normal_distribution<double> normal(0.0, sigma_px);
  for (ModelImage& image : model->images) {
    for (Point2D& point : image.points2D) {
      point.x_in_image_px += Eigen::Vector2d(normal(*random), normal(*random));
    }
  }
}

TEST(MarkerSides, AreThoseOfTheShapeInAnyFrame) {
  Model model = ExampleModel();
  TransformModel(ExampleSim3(2.0), &model);
  const auto markers = MeasureSides(model, ExampleLayout());
  ASSERT_EQ(markers.size(), 8u);
  EXPECT_NEAR(MeanSide(markers[0].sides), 0.2, 1e-12);
  EXPECT_NEAR(MeanSide(markers[7].sides), 0.1, 1e-12);
  EXPECT_NEAR(markers[3].HorizontalOverVertical(), 1.0, 1e-12);
  EXPECT_EQ(markers[3].part, "sail");
  EXPECT_LT(*markers[3].mean_sigma, 1e-9);  // exact image points
  const auto without_model = MeasureSides(ShapeFromModel(model, ExampleLayout()));
  EXPECT_EQ(without_model[7].sides, markers[7].sides);
  EXPECT_FALSE(without_model[7].mean_sigma || without_model[7].side_px);
}

TEST(MarkerSides, SizeInTheImagesIsFocalLengthTimesSizeOverDistance) {
  const auto markers = MeasureSides(ExampleModel(), ExampleLayout());
  // Marker 120 is 4 m in front of the cameras, off their axes, where squares look up to 10 %
  // larger; 121 has half its size.
  EXPECT_NEAR(*markers[6].side_px, 1.05 * 1500 * 0.1 / 4, 2.0);
  EXPECT_NEAR(*markers[7].side_px / *markers[6].side_px, 0.5, 0.02);
}

TEST(MarkerSides, IntersectionRestoresDisplacedPoints) {
  for (const double scale : {1.0, 50.0}) {
    Model model = ExampleModel();
    TransformModel(ExampleSim3(scale), &model);
    const Model truth = model;
    for (auto& [id, point] : model.points3D) {
      point.x_in_world += scale * Eigen::Vector3d(0.01, -0.02, 0.03);
    }
    RetriangulateCorners(0.0, &model);
    for (const auto& [id, point] : model.points3D) {
      EXPECT_LT((point.x_in_world - truth.points3D.at(id).x_in_world).norm(), 1e-9 * scale) << id;
    }
  }
}

TEST(MarkerSides, IntersectionIsTheLeastSumOfSquares) {
  Model model = ExampleModel();
  AddImageNoise(0.5, 3, &model);
  RetriangulateCorners(0.0, &model);
  const double least = SummarizeReprojectionErrors(model).rms;
  EXPECT_GT(least, 0.1);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step_m : {-1e-3, 1e-3}) {
      Model moved = model;
      moved.points3D.at(12).x_in_world[axis] += step_m;
      EXPECT_GT(SummarizeReprojectionErrors(moved).rms, least);
    }
  }
}

TEST(MarkerSides, PointsThatOneImageSeesStay) {
  Model model = ExampleModel();
  Point3D& point = model.points3D.at(11);
  const std::vector<TrackElement> track = point.track;
  for (std::size_t i = 1; i < track.size(); ++i) RemoveObservation(&model, 11, track[i]);
  const Eigen::Vector3d before = model.points3D.at(11).x_in_world;
  model.points3D.at(12).x_in_world.x() += 0.01;
  RetriangulateCorners(0.0, &model);
  EXPECT_EQ(model.points3D.at(11).x_in_world, before);
  EXPECT_NEAR(MeanSide(MeasureSides(model, ExampleLayout())[0].sides), 0.1, 1e-9);
  EXPECT_FALSE(MeasureSides(model, ExampleLayout())[0].mean_sigma.has_value());
}

// An inset of b px along both sides of a square reduces its size by 2 b px in every image.
TEST(MarkerSides, ApparentInsetIsTakenOut) {
  constexpr double kInset_px = 0.3;
  Model model = ExampleModel();
  const Model truth = model;
  for (ModelImage& image : model.images) {
    for (std::size_t i = 0; i + 3 < image.points2D.size(); i += 4) {  // corners 1..4 in order
      const auto at = [&](std::size_t corner) {
        return truth.FindImage(image.image_id)->points2D[i + corner % 4].x_in_image_px;
      };
      for (std::size_t corner = 0; corner < 4; ++corner) {
        image.points2D[i + corner].x_in_image_px +=
            kInset_px * ((at(corner + 1) - at(corner)).normalized() +
                         (at(corner + 3) - at(corner)).normalized());
      }
    }
  }
  Model seen = model;
  RetriangulateCorners(0.0, &seen);
  const auto too_small = MeasureSides(seen, ExampleLayout());
  EXPECT_NEAR(MeanSide(too_small[6].sides) / 0.1, 1 - 2 * kInset_px / *too_small[6].side_px, 5e-4);
  RetriangulateCorners(kInset_px, &model);
  for (const MeasuredMarkerSides& marker : MeasureSides(model, ExampleLayout())) {
    EXPECT_NEAR(MeanSide(marker.sides), MarkerLength(ExampleLayout(), marker.marker_id), 1e-6);
  }
}

TEST(MarkerSides, SigmasAreCalibrated) {
  std::mt19937 random(8);
  constexpr int kNumRuns = 200;
  std::vector<double> means, ratios, mean_sigmas, ratio_sigmas;
  for (int run = 0; run < kNumRuns; ++run) {
    Model model = ExampleModel();
    AddNormalNoise(0.1, &random, &model);
    RetriangulateCorners(0.0, &model);
    const MeasuredMarkerSides marker = MeasureSides(model, ExampleLayout())[4];
    means.push_back(MeanSide(marker.sides) / 0.1 - 1);
    ratios.push_back(marker.HorizontalOverVertical() - 1);
    mean_sigmas.push_back(*marker.mean_sigma);
    ratio_sigmas.push_back(*marker.ratio_sigma);
  }
  // CameraFactor() assumes adjusted cameras: it subtracts 6 unknowns for each of the 3 cameras from
  // the redundancy of 96. Here the cameras are exact, so the sigmas come out larger by
  // sqrt(96 / 78).
  const double factor = std::sqrt(96.0 / 78.0);
  EXPECT_NEAR(ComputeStatistics(mean_sigmas).rms / ComputeStatistics(means).standard_deviation,
              factor, 0.2);
  EXPECT_NEAR(ComputeStatistics(ratio_sigmas).rms / ComputeStatistics(ratios).standard_deviation,
              factor, 0.2);
  EXPECT_LT(std::abs(ComputeStatistics(means).mean), 5e-4);
}

}  // namespace
}  // namespace velamap
