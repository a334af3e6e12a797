#include "reconstruct/sizes/runaway_markers.h"

#include <gmock/gmock.h>

#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class RunawayMarkers : public testing::Test {
 protected:
  RunawayMarkers() {
    SyntheticSceneOptions options;
    options.num_rows = 3;
    options.num_columns = 4;
    scene_ = MakeSyntheticScene(options);
    marker_id_ = scene_.x_in_world.begin()->first;
  }

  Eigen::Vector3d& Corner(int corner, Model* model) const {
    return model->points3D.at(Point3DIdFromCorner({marker_id_, corner})).x_in_world;
  }

  SyntheticScene scene_;
  int marker_id_ = 0;
};

TEST_F(RunawayMarkers, ReturnFromADistanceThatOneImageAllows) {
  Model model = MakeSceneModel(scene_);
  const Eigen::Vector3d camera = Inverse(model.images.front().cam_from_world).translation;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    Eigen::Vector3d& x_in_world = Corner(corner, &model);
    x_in_world = camera + 1e4 * (x_in_world - camera);
  }
  EXPECT_THAT(PlaceRunawayMarkersAnew(scene_.layout, &model), ElementsAre(marker_id_));
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Eigen::Vector3d& true_m =
        scene_.x_in_world.at(marker_id_)[static_cast<std::size_t>(corner)];
    EXPECT_LT((Corner(corner, &model) - true_m).norm(), 1e-3);
  }
}

TEST_F(RunawayMarkers, OfAWrongPrintStayWhereTheImagesShowThem) {
  ResizeMarker(marker_id_, 3.0, &scene_);
  Model model = MakeSceneModel(scene_);
  const Eigen::Vector3d before = Corner(1, &model);
  EXPECT_THAT(PlaceRunawayMarkersAnew(scene_.layout, &model), IsEmpty());
  EXPECT_EQ(Corner(1, &model), before);
}

}  // namespace
}  // namespace velamap
