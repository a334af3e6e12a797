#include "reconstruct/model/gauge.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

const Sim3 kSimilarity{0.03, Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized(), {5, -8, 13}};

std::vector<ImageId> Order(const Model& model) {
  std::vector<ImageId> order;
  for (const ModelImage& image : model.images) order.push_back(image.image_id);
  return order;
}

TEST(TransformModel, LeavesEveryProjection) {
  Model model = MakeSheetModel();
  const Model truth = model;
  TransformModel(kSimilarity, &model);
  CheckModel(model);
  EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-8);
  const Eigen::Vector3d expected = kSimilarity * truth.points3D.at(22).x_in_world;
  EXPECT_LT((model.points3D.at(22).x_in_world - expected).norm(), 1e-12);
}

TEST(OrderForGauge, WorldIsTheFirstCameraAndTheWidestBaselineIsSecond) {
  Model model = MakeSheetModel();
  OrderForGauge(4, &model);
  CheckModel(model);
  EXPECT_EQ(model.images[0].image_id, 4u);
  EXPECT_EQ(model.images[0].cam_from_world.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(model.images[0].cam_from_world.rotation.coeffs(),
            Eigen::Quaterniond::Identity().coeffs());
  const double baseline = std::abs(model.images[1].cam_from_world.translation.x());
  for (const ModelImage& image : model.images) {
    EXPECT_LE(std::abs(image.cam_from_world.translation.x()), baseline);
  }
  EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-8);
}

TEST(OrderForGauge, TheRestFollowsById) {
  Model model = MakeSheetModel();
  OrderForGauge(4, &model);
  const std::vector<ImageId> order = Order(model);
  EXPECT_TRUE(std::is_sorted(order.begin() + 2, order.end()));
  EXPECT_EQ(order.size(), 9u);
}

TEST(OrderForGauge, OrderOfTheInputIsWithoutEffect) {
  Model model = MakeSheetModel(), reversed = model;
  std::reverse(reversed.images.begin(), reversed.images.end());
  OrderForGauge(4, &model);
  OrderForGauge(4, &reversed);
  EXPECT_EQ(Bytes(model), Bytes(reversed));
}

TEST(OrderForGauge, SimilarityOfTheInputChangesTheScaleOnly) {
  Model model = MakeSheetModel(), moved = model;
  TransformModel(kSimilarity, &moved);
  OrderForGauge(4, &model);
  OrderForGauge(4, &moved);
  EXPECT_EQ(Order(model), Order(moved));
  for (const auto& [point3D_id, point] : model.points3D) {
    EXPECT_LT(
        (kSimilarity.scale * point.x_in_world - moved.points3D.at(point3D_id).x_in_world).norm(),
        1e-12);
  }
}

TEST(OrderForGauge, UnknownFirstImageIsABug) {
  Model model = MakeSheetModel();
  EXPECT_THROW(OrderForGauge(99, &model), std::logic_error);
}

}  // namespace
}  // namespace velamap
