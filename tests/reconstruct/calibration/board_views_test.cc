#include "reconstruct/calibration/board_views.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

using testing::ElementsAre;

// Two markers with sides of 40 px, foreshortened along x by the tilt, around `center_px`.
DatabaseImage View(ImageId image_id, const Eigen::Vector2d& center_px, double tilt_deg,
                   double sigma_px = 0.05) {
  DatabaseImage image;
  image.image_id = image_id;
  image.detections.image_name = "view" + std::to_string(image_id);
  const double half_x = 20 * std::cos(kRadPerDeg * tilt_deg), half_y = 20;
  for (int id = 0; id < 2; ++id) {
    const Eigen::Vector2d middle = center_px + Eigen::Vector2d(0, 60 * id - 30);
    MarkerDetection marker;
    marker.marker_id = id;
    marker.corners_in_image_px = {
        middle + Eigen::Vector2d(-half_x, -half_y), middle + Eigen::Vector2d(half_x, -half_y),
        middle + Eigen::Vector2d(half_x, half_y), middle + Eigen::Vector2d(-half_x, half_y)};
    marker.corner_sigma_px = {sigma_px, sigma_px, sigma_px, sigma_px};
    image.detections.markers.push_back(marker);
  }
  return image;
}

TEST(PictureGrid, CellsAreNearlySquareAndHoldAllOfThePicture) {
  const PictureGrid grid = MakePictureGrid(1920, 1080, 8);
  EXPECT_EQ(grid.num_columns, 8);
  EXPECT_EQ(grid.num_rows, 5);  // 4.5 squares
  EXPECT_EQ(grid.CellOf({0, 0}), 0);
  EXPECT_EQ(grid.CellOf({1919.9, 1079.9}), grid.NumCells() - 1);
  EXPECT_EQ(grid.CellOf({-50, 5000}), 32);  // the nearest: bottom left
}

TEST(DescribeBoardViews, TiltFollowsFromForeshortening) {
  DatabaseImage of_one_marker = View(9, {500, 500}, 0);
  of_one_marker.detections.markers.pop_back();
  const std::vector<BoardView> views = DescribeBoardViews(
      {View(1, {500, 500}, 0), View(2, {500, 500}, 40), of_one_marker, View(3, {500, 500}, 30, 0)},
      0.3);
  ASSERT_EQ(views.size(), 3u);  // one marker shows no board
  EXPECT_NEAR(views[0].tilt_deg, 0, 1e-6);
  EXPECT_EQ(views[0].Tilt(), 0);
  EXPECT_NEAR(views[1].tilt_deg, 40, 1e-6);
  EXPECT_NEAR(std::remainder(views[1].tilt_direction_deg, 180.0), 0, 1e-6);  // along x
  EXPECT_EQ(views[1].Tilt(), 1);
  EXPECT_NEAR(views[1].corner_sigma_px, 0.05, 1e-12);
  EXPECT_NEAR(views[2].corner_sigma_px, 0.3, 1e-12);  // has none of its own
}

TEST(ChooseBoardViews, PrefersNewPlacesTiltsAndSharpPictures) {
  const PictureGrid grid = MakePictureGrid(1600, 1200, kNumCoverageCells);
  // Twice the same place; another place; the first place with another tilt, sharp and blurred.
  const std::vector<BoardView> views =
      DescribeBoardViews({View(1, {300, 300}, 0), View(2, {300, 300}, 0), View(3, {1300, 900}, 0),
                          View(4, {300, 300}, 40), View(5, {300, 300}, 40, 0.5)},
                         0.3);
  EXPECT_THAT(ChooseBoardViews(views, grid, 3), ElementsAre(0, 2, 3));
  EXPECT_EQ(ChooseBoardViews(views, grid, 99).size(), views.size());
  EXPECT_TRUE(ChooseBoardViews({}, grid, 5).empty());
}

TEST(CountInCells, CountsEachCornerOnce) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x_px(0, 1600), y_px(0, 1200), tilt_deg(0, 60);
  std::vector<DatabaseImage> images;
  for (ImageId id = 1; id <= 20; ++id) {
    images.push_back(View(id, {x_px(random), y_px(random)}, tilt_deg(random)));
  }
  const std::vector<int> counts =
      CountInCells(DescribeBoardViews(images, 0.3), MakePictureGrid(1600, 1200, 8));
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 20 * 2 * 4);
}

}  // namespace
}  // namespace velamap
