#include <cmath>

#include <gmock/gmock.h>

#include "tests/reconstruct/sizes/printed_scene.h"

namespace velamap {
namespace {

class CurvedScene : public PrintedSceneTest {
 protected:
  // A board that is bent around an axis along the columns of markers; the camera sees it from
  // outside. Lengths along the surface stay.
  void Bend(double radius_m) {
    SyntheticSceneOptions options;
    options.kind = SceneKind::kPlane;
    options.num_rows = 5;
    options.num_columns = 5;
    options.spacing_m = 0.15;
    scene_ = MakeSyntheticScene(options);
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const auto& [marker_id, x] : scene_.x_in_world) {
      center += x[0] / static_cast<double>(scene_.x_in_world.size());
    }
    const auto& first = scene_.x_in_world.begin()->second;
    const Eigen::Vector3d right = (first[2] - first[1]).normalized();
    const Eigen::Vector3d up = (first[1] - first[4]).normalized();
    const Eigen::Vector3d out = right.cross(up);
    for (auto& [marker_id, x] : scene_.x_in_world) {
      for (Eigen::Vector3d& place : x) {
        const double u = right.dot(place - center), v = up.dot(place - center);
        const double angle = u / radius_m;
        place = center + radius_m * std::sin(angle) * right + v * up +
                radius_m * (std::cos(angle) - 1) * out;
      }
    }
    ProjectAnew(&scene_);
  }
};

// Sides across the axis are printed 0.26 % longer than their corners are apart.
TEST_F(CurvedScene, OfMarkersThatBendKeepsItsSize) {
  Bend(0.4);
  options_.bent_markers = true;
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_LT(std::abs(ScaleError()), 3e-4);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 1.2e-3);
  EXPECT_THAT(summary.warnings, testing::IsEmpty());
}

TEST_F(CurvedScene, OfMarkersThatMayBeStiffSaysWhatItWouldMean) {
  Bend(0.4);
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_NEAR(ScaleError(), 1.3e-3, 3e-4);
  EXPECT_THAT(summary.warnings, testing::Contains(testing::HasSubstr("bent_markers")));
}

TEST_F(CurvedScene, ThatIsFlatKeepsItsSigma) {
  Bend(1e6);
  options_.bent_markers = true;
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_LT(std::abs(ScaleError()), 3e-4);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 1.1e-3);
  EXPECT_THAT(summary.warnings, testing::IsEmpty());
}

}  // namespace
}  // namespace velamap
