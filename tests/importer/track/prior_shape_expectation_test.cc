#include "importer/track/prior_shape_expectation.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr int kNumColumns = 10, kNumRows = 8;
constexpr int kTurnedAwayId = 900, kOutsideId = 901, kBehindId = 902;

using Corners = std::array<Eigen::Vector3d, kNumCorners>;

Camera WideCamera() {
  return {CameraModel::kOpenCV, 1920, 1080, {1100, 1105, 955, 548, -0.12, 0.02, 1e-3, -5e-4}};
}

// Squares of 100 mm on a bent sheet of 4 by 3 m, x right, y up, z towards the camera.
Corners OnSheet(double x_m, double y_m, double side_m = 0.1) {
  const auto bent = [](double x, double y) {
    return Eigen::Vector3d(x, y, 0.15 * x * x + 0.05 * x * y);
  };
  const double h = 0.5 * side_m;
  return {bent(x_m - h, y_m + h), bent(x_m + h, y_m + h), bent(x_m + h, y_m - h),
          bent(x_m - h, y_m - h)};
}

PriorShape SheetShape() {
  PriorShape prior;
  for (int row = 0; row < kNumRows; ++row) {
    for (int column = 0; column < kNumColumns; ++column) {
      prior[row * kNumColumns + column] = OnSheet(-1.8 + 0.4 * column, -1.4 + 0.4 * row);
    }
  }
  Corners turned_away = OnSheet(0.2, 0.2);
  std::swap(turned_away[0], turned_away[1]);
  std::swap(turned_away[2], turned_away[3]);
  prior[kTurnedAwayId] = turned_away;
  prior[kOutsideId] = OnSheet(9.0, 0.0);
  prior[kBehindId] = OnSheet(0.0, 0.0);
  for (Eigen::Vector3d& x : prior[kBehindId]) x.z() += 20.0;
  return prior;
}

Rigid3 CameraPose() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(kPi - 0.1, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY())),
          {0.1, -0.05, 4.0}};
}

MarkerQuad Seen(const PriorShape& prior, int marker_id) {
  MarkerQuad quad;
  quad.marker_id = marker_id;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    quad.corners_px[c] = *ImageFromCam(WideCamera(), CameraPose() * prior.at(marker_id)[c]) -
                         Eigen::Vector2d(0.5, 0.5);
  }
  return quad;
}

// Every marker of the sheet but each `skip`-th.
std::vector<MarkerQuad> SeenWithout(const PriorShape& prior, int skip) {
  std::vector<MarkerQuad> found;
  for (int id = 0; id < kNumRows * kNumColumns; ++id) {
    if (id % skip != 0) found.push_back(Seen(prior, id));
  }
  return found;
}

struct Expectation {
  PriorShapeAgreement agreement;
  std::vector<ExpectedMarker> expected;
};

Expectation Expect(const PriorShape& prior, const std::vector<MarkerQuad>& found) {
  Expectation result;
  const auto view = PlaceInPriorShape(prior, WideCamera(), found, &result.agreement);
  if (view) result.expected = ExpectByPriorShape(prior, WideCamera(), *view, found);
  return result;
}

double MaxError(const PriorShape& prior, const std::vector<ExpectedMarker>& expected) {
  double max_px = 0.0;
  for (const ExpectedMarker& marker : expected) {
    const MarkerQuad truth = Seen(prior, marker.quad.marker_id);
    max_px = std::max(max_px, MaxCornerShift(marker.quad.corners_px, truth.corners_px));
  }
  return max_px;
}

TEST(ExpectByPriorShape, MissingMarkersAreWhereTheyAre) {
  const PriorShape prior = SheetShape();
  const Expectation result = Expect(prior, SeenWithout(prior, 4));
  EXPECT_EQ(result.agreement.num_known, 60);
  EXPECT_EQ(result.agreement.num_agreeing, 60);
  ASSERT_EQ(result.expected.size(), 20u);
  EXPECT_LT(MaxError(prior, result.expected), 1e-6);
  for (const ExpectedMarker& marker : result.expected) {
    EXPECT_EQ(marker.quad.marker_id % 4, 0);
    EXPECT_GT(marker.reach_px, 4.0);
    EXPECT_LT(marker.reach_px, QuadMeanSide(marker.quad.corners_px));
  }
}

TEST(ExpectByPriorShape, FourMarkersAreEnoughAndThreeAreNot) {
  const PriorShape prior = SheetShape();
  std::vector<MarkerQuad> found = {Seen(prior, 11), Seen(prior, 18), Seen(prior, 65),
                                   Seen(prior, 44)};
  const Expectation four = Expect(prior, found);
  EXPECT_EQ(four.expected.size(), 76u);
  EXPECT_LT(MaxError(prior, four.expected), 1e-4);
  found.pop_back();
  const Expectation three = Expect(prior, found);
  EXPECT_EQ(three.agreement.num_known, 0);  // too few to tell
  EXPECT_EQ(three.agreement.num_agreeing, 0);
  EXPECT_TRUE(three.expected.empty());
}

TEST(ExpectByPriorShape, FalseAndDoubleMarkersMoveNothing) {
  const PriorShape prior = SheetShape();
  std::vector<MarkerQuad> found = SeenWithout(prior, 4);
  for (std::size_t i = 0; i < 20; ++i) {
    std::swap(found[i].marker_id, found[found.size() - 1 - i].marker_id);
  }
  found.push_back(Seen(prior, 30));  // which is there already
  found.push_back({5000, Seen(prior, 30).corners_px});
  const Expectation result = Expect(prior, found);
  EXPECT_EQ(result.agreement.num_known, 59);
  EXPECT_EQ(result.agreement.num_agreeing, 0);  // 20 of them: most are elsewhere
  EXPECT_TRUE(result.expected.empty());

  for (std::size_t i = 10; i < 20; ++i) {
    std::swap(found[i].marker_id, found[59 - i].marker_id);
  }
  const Expectation fewer_false = Expect(prior, found);
  EXPECT_EQ(fewer_false.agreement.num_agreeing, 39);
  EXPECT_EQ(fewer_false.expected.size(), 20u);
  EXPECT_LT(MaxError(prior, fewer_false.expected), 1e-6);
}

TEST(ExpectByPriorShape, OrderOfWhatIsFoundChangesNothing) {
  const PriorShape prior = SheetShape();
  std::vector<MarkerQuad> found = SeenWithout(prior, 3);
  found[5].marker_id = 33;  // which is not among them
  const Expectation before = Expect(prior, found);
  std::shuffle(found.begin(), found.end(), std::mt19937(4));
  const Expectation after = Expect(prior, found);
  ASSERT_EQ(before.expected.size(), after.expected.size());
  for (std::size_t i = 0; i < before.expected.size(); ++i) {
    EXPECT_EQ(before.expected[i].quad.marker_id, after.expected[i].quad.marker_id);
    EXPECT_EQ(MaxCornerShift(before.expected[i].quad.corners_px, after.expected[i].quad.corners_px),
              0.0);
  }
}

TEST(ExpectByPriorShape, FrameAndScaleOfThePriorShapeChangeNothing) {
  const PriorShape prior = SheetShape();
  PriorShape moved = prior;
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.1).normalized();
  for (auto& [id, corners] : moved) {
    for (Eigen::Vector3d& x : corners) x = 37.0 * (rotation * x) + Eigen::Vector3d(5, -300, 20);
  }
  const std::vector<MarkerQuad> found = SeenWithout(prior, 4);
  const Expectation result = Expect(moved, found);
  ASSERT_EQ(result.expected.size(), 20u);
  EXPECT_LT(MaxError(prior, result.expected), 1e-6);
}

TEST(ExpectByPriorShape, FollowsClothThatHasMovedSince) {
  const PriorShape prior = SheetShape();
  PriorShape now = prior;
  for (auto& [id, corners] : now) {  // the head bends by 80 mm, some 20 px
    for (Eigen::Vector3d& x : corners) x.x() += 0.08 * std::pow(std::max(0.0, x.y()) / 1.4, 2);
  }
  const Expectation result = Expect(prior, SeenWithout(now, 4));
  ASSERT_EQ(result.expected.size(), 20u);
  EXPECT_GT(MaxError(prior, result.expected), 10.0);
  for (const ExpectedMarker& marker : result.expected) {
    const MarkerQuad truth = Seen(now, marker.quad.marker_id);
    EXPECT_LT((QuadCenter(truth.corners_px) - QuadCenter(marker.quad.corners_px)).norm(),
              marker.reach_px)
        << marker.quad.marker_id;
  }
}

TEST(PlaceInPriorShape, DegenerateShapesGiveNothing) {
  const PriorShape prior = SheetShape();
  const std::vector<MarkerQuad> found = SeenWithout(prior, 4);
  PriorShape point = prior, line = prior, tiny = prior, huge = prior;
  for (auto& [id, corners] : point) corners.fill({1, 2, 3});
  for (auto& [id, corners] : line) {
    for (Eigen::Vector3d& x : corners) x = {x.x(), 2 * x.x(), 0};
  }
  for (auto& [id, corners] : tiny) {
    for (Eigen::Vector3d& x : corners) x *= 1e-200;
  }
  for (auto& [id, corners] : huge) {
    for (Eigen::Vector3d& x : corners) x *= 1e200;
  }
  for (const PriorShape& flawed : {point, line, tiny, huge}) {
    PriorShapeAgreement agreement;
    EXPECT_FALSE(PlaceInPriorShape(flawed, WideCamera(), found, &agreement));
    EXPECT_EQ(agreement.num_known, 60);
    EXPECT_EQ(agreement.num_agreeing, 0);
  }
}

TEST(ExpectByPriorShape, TheMiddleOfThePictureIsInView) {
  const PriorShape prior = SheetShape();
  const Rigid3 shape_from_cam = Inverse(CameraPose());
  PriorShape with_middle = prior;
  const double h = 0.05;
  with_middle[950] = {
      shape_from_cam * Eigen::Vector3d(0, 0, 4), shape_from_cam * Eigen::Vector3d(h, 0, 4),
      shape_from_cam * Eigen::Vector3d(h, h, 4), shape_from_cam * Eigen::Vector3d(0, h, 4)};
  EXPECT_EQ(Expect(with_middle, SeenWithout(prior, 4)).expected.back().quad.marker_id, 950);
}

TEST(PlaceInPriorShape, AnEmptyShapeHoldsNothing) {
  PriorShapeAgreement agreement{7, 7};
  EXPECT_FALSE(PlaceInPriorShape({}, WideCamera(), SeenWithout(SheetShape(), 4), &agreement));
  EXPECT_EQ(agreement.num_known, 0);
  EXPECT_EQ(agreement.num_agreeing, 0);
}

}  // namespace
}  // namespace velamap
