#include <cmath>
#include <utility>

#include <gmock/gmock.h>

#include "tests/reconstruct/sizes/printed_scene.h"

namespace velamap {
namespace {

class CurvedScene : public PrintedSceneTest {
 protected:
  // A board that is bent around an axis along the columns of markers; the camera sees it from
  // outside. Lengths along the surface stay, except on stiff markers, which touch the surface with
  // their middle. `turn_rad` is the angle of the axis.
  void Bend(double radius_m, bool markers_are_stiff = false, double turn_rad = 0.0) {
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
    const Eigen::Vector3d along_rows = (first[2] - first[1]).normalized();
    const Eigen::Vector3d along_columns = (first[1] - first[4]).normalized();
    const Eigen::Vector3d out = along_rows.cross(along_columns);
    const Eigen::AngleAxisd turn(turn_rad, out);
    const Eigen::Vector3d right = turn * along_rows, up = turn * along_columns;
    for (auto& [marker_id, x] : scene_.x_in_world) {
      const double middle_u = right.dot(x[0] - center);
      for (Eigen::Vector3d& place : x) {
        const double u = right.dot(place - center), v = up.dot(place - center);
        const double angle = (markers_are_stiff ? middle_u : u) / radius_m;
        place = center + radius_m * std::sin(angle) * right + v * up +
                radius_m * (std::cos(angle) - 1) * out;
        if (markers_are_stiff) {
          place += (u - middle_u) * (std::cos(angle) * right - std::sin(angle) * out);
        }
      }
    }
    ProjectAnew(&scene_);
  }
};

// Sides across the axis are printed 0.26 % longer than their corners are apart.
TEST_F(CurvedScene, OfMarkersThatBendKeepsItsSize) {
  Bend(0.4);
  options_.bent_markers = BentMarkers::kBent;
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_LT(std::abs(ScaleError()), 3e-4);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 1.2e-3);
  EXPECT_THAT(summary.warnings, testing::IsEmpty());
}

// The shortening is 1.04 % along the bend, so the proportions of the markers show whether they
// bend.
TEST_F(CurvedScene, ShowsWhetherItsMarkersBend) {
  for (const auto& [markers_are_stiff, turn_rad] :
       {std::pair{false, 0.0}, {true, 0.0}, {false, 0.785}, {true, 0.785}}) {
    SCOPED_TRACE(testing::Message() << markers_are_stiff << ' ' << turn_rad);
    Bend(0.2, markers_are_stiff, turn_rad);
    const MarkerAdjustmentSummary summary = Adjust();
    EXPECT_LT(summary.uncertainty.relative_scale_sigma, 2e-3);
    EXPECT_LT(std::abs(ScaleError()), 5e-4);
    EXPECT_THAT(summary.warnings, testing::IsEmpty());
  }
}

TEST_F(CurvedScene, OfMarkersThatMayBeStiffSaysWhatItWouldMean) {
  Bend(0.4);
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_NEAR(ScaleError(), 1.3e-3, 3e-4);
  EXPECT_THAT(summary.warnings, testing::Contains(testing::HasSubstr("bent_markers")));
}

TEST_F(CurvedScene, ThatIsFlatKeepsItsSigma) {
  Bend(1e6);
  options_.bent_markers = BentMarkers::kBent;
  const MarkerAdjustmentSummary summary = Adjust();
  EXPECT_LT(std::abs(ScaleError()), 3e-4);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 1.1e-3);
  EXPECT_THAT(summary.warnings, testing::IsEmpty());
}

}  // namespace
}  // namespace velamap
