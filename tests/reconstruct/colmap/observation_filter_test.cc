#include "reconstruct/colmap/observation_filter.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

// Leaves the point the first `num_images` of its track.
void Shorten(Point3DId point3D_id, std::size_t num_images, Model* model) {
  const std::vector<TrackElement> track = model->points3D.at(point3D_id).track;
  for (std::size_t i = num_images; i < track.size(); ++i) {
    RemoveObservation(model, point3D_id, track[i]);
  }
}

void DropPoint(Point3DId point3D_id, Model* model) {
  Shorten(point3D_id, 0, model);
  model->points3D.erase(point3D_id);
}

TEST(RemoveUnprovenCorners, OfMarkersThatAreNotWholeOnly) {
  Model model = MakeSheetModel();
  for (Point3DId corner = 1; corner <= 4; ++corner) {
    Shorten(10 + corner, 2, &model);  // whole, seen by two images
    Shorten(20 + corner, 2, &model);  // lost a corner, seen by two
    Shorten(30 + corner, 3, &model);  // lost a corner, seen by three
  }
  DropPoint(24, &model);
  DropPoint(34, &model);
  std::vector<RemovedObservation> removed;
  EXPECT_TRUE(RemoveUnprovenCorners(&model, &removed));
  std::set<Point3DId> removed_ids;
  for (const RemovedObservation& observation : removed) removed_ids.insert(observation.point3D_id);
  EXPECT_EQ(removed_ids, (std::set<Point3DId>{21, 22, 23}));
  EXPECT_EQ(removed.size(), 6u);
  std::vector<ImageId> removed_images;
  RemoveUnderconstrained(2, &model, &removed_images);
  EXPECT_EQ(model.points3D.count(21), 0u);
  EXPECT_EQ(model.points3D.count(11), 1u);
  EXPECT_EQ(model.points3D.count(31), 1u);
  EXPECT_FALSE(RemoveUnprovenCorners(&model, &removed));
  EXPECT_EQ(FindModelFault(model), "");
}

}  // namespace
}  // namespace velamap
