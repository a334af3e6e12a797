#include "importer/refine/saddle_corners.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

constexpr int kNumCells = 8;

// A marker whose middle is light.
cv::Mat CellsWithLightMiddle(int num_cells = kNumCells) {
  cv::Mat cells(num_cells, num_cells, CV_8UC1, cv::Scalar(0));
  cells(cv::Rect(num_cells / 2 - 1, num_cells / 2 - 1, 2, 2)) = 255;
  return cells;
}

// A marker of 64.5 px, turned by 0.2, on light ground, each edge a blurred step; with others
// of the same size at all four corners if asked for. `spread_px` makes every dark square larger.
// `quiet_zone_cells`: dark ground begins this far from the marker.
struct Picture {
  Eigen::Vector2d center_px{100.3, 99.6};
  double half_px = 32.25;
  double angle = 0.2;
  double blur_px = 0.9;
  double spread_px = 0.0;
  bool touching = true;
  double gap_px = 0.0;  // between the corners, along both sides
  double quiet_zone_cells = 100.0;
  double gamma = 1.0;

  QuadCorners Corners() const {
    QuadCorners corners;
    const double signs[kNumCorners][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      corners[i] = center_px + Eigen::Rotation2Dd(angle) *
                                   (half_px * Eigen::Vector2d(signs[i][0], signs[i][1]));
    }
    return corners;
  }

  double Inside(double distance_px) const {
    return 0.5 * std::erfc((distance_px - spread_px) / (blur_px * std::sqrt(2.0)));
  }

  cv::Mat Draw() const {
    cv::Mat gray(200, 200, CV_8UC1);
    for (int y = 0; y < gray.rows; ++y) {
      for (int x = 0; x < gray.cols; ++x) {
        const Eigen::Vector2d p = Eigen::Rotation2Dd(-angle) * (Eigen::Vector2d(x, y) - center_px);
        const double marker = Inside(std::abs(p.x()) - half_px) * Inside(std::abs(p.y()) - half_px);
        const double others =
            Inside(half_px + gap_px - std::abs(p.x())) * Inside(half_px + gap_px - std::abs(p.y()));
        const double cell_px = 2 * half_px / kNumCells;
        const double middle = Inside(std::abs(p.x()) - cell_px) * Inside(std::abs(p.y()) - cell_px);
        const double paper_px = half_px + quiet_zone_cells * cell_px;
        const double ground =
            1 - Inside(std::abs(p.x()) - paper_px) * Inside(std::abs(p.y()) - paper_px);
        const double dark = std::min(1.0, marker - middle + ground + (touching ? others : 0.0));
        gray.at<std::uint8_t>(y, x) =
            static_cast<std::uint8_t>(std::lround(30 + 180 * std::pow(1 - dark, 1 / gamma)));
      }
    }
    return gray;
  }
};

TEST(SaddleCornersTest, FindsTheMeetingPointOfTwoSquares) {
  const Picture picture;
  QuadCorners corners = picture.Corners();
  for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(0.8, -0.6);
  EXPECT_EQ(
      RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(), kSaddleReachOfQuad, &corners), 4);
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    EXPECT_LT((corners[i] - picture.Corners()[i]).norm(), 0.04) << i;
  }
}

TEST(SaddleCornersTest, SpreadInkDoesNotMoveThem) {
  Picture picture;
  picture.spread_px = 0.3;
  QuadCorners corners = picture.Corners();
  EXPECT_EQ(
      RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(), kSaddleReachOfQuad, &corners), 4);
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    EXPECT_LT((corners[i] - picture.Corners()[i]).norm(), 0.04) << i;
  }
}

// Markers with narrow margins that lie corner to corner. The middle of the gap is a saddle point.
TEST(SaddleCornersTest, LeavesCornersThatAGapKeepsApart) {
  Picture picture;
  for (const double gap_px : {2.0, 3.0, 4.0}) {
    picture.gap_px = gap_px;
    QuadCorners corners = picture.Corners();
    for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(0.05, -0.04);
    const QuadCorners before = corners;
    EXPECT_EQ(
        RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(), kSaddleReachOfFit, &corners),
        0);
    EXPECT_EQ(corners, before);
  }
}

TEST(SaddleCornersTest, LeavesTheCornersOfALonelySquare) {
  Picture picture;
  picture.touching = false;
  QuadCorners corners = picture.Corners();
  corners[0].x() += 0.8;
  const QuadCorners before = corners;
  EXPECT_EQ(
      RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(), kSaddleReachOfQuad, &corners), 0);
  EXPECT_EQ(corners, before);
}

// The zone fades beside the sides and fades twice at the corners.
TEST(SaddleCornersTest, LeavesTheCornersOfANarrowQuietZoneOnDarkGround) {
  for (const double gamma : {1.0, 2.2}) {
    for (const double quiet_zone_cells : {0.2, 0.3, 0.4, 0.5}) {
      for (const double blur_px : {0.6, 1.0, 1.6}) {
        SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", quiet zone " << quiet_zone_cells
                                        << ", blur " << blur_px);
        Picture picture;
        picture.touching = false;
        picture.quiet_zone_cells = quiet_zone_cells;
        picture.blur_px = blur_px;
        picture.gamma = gamma;
        QuadCorners corners = picture.Corners();
        EXPECT_EQ(RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(), kSaddleReachOfQuad,
                                      &corners),
                  0);
      }
    }
  }
}

TEST(SaddleCornersTest, LeavesCellsThatAreTooSmallToTell) {
  const Picture picture;
  QuadCorners corners = picture.Corners();
  EXPECT_EQ(
      RefineSaddleCorners(picture.Draw(), CellsWithLightMiddle(20), kSaddleReachOfQuad, &corners),
      0);
}

}  // namespace
}  // namespace velamap
