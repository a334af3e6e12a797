#include "exporters/shape/shape_frame.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/shape/shape_transform.h"
#include "importer/base/error.h"
#include "tests/exporters/sail/sail_shapes.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::HasSubstr;

// The example sail with a hull: a strip of upright markers along y = -0.5, below the foot.
Sail SailWithHull() {
  Sail sail = ExampleSail();
  std::vector<Eigen::Vector3d> hull_centers_m;
  for (int i = 0; i < 4; ++i) hull_centers_m.emplace_back(0.3 + 0.5 * i, -0.5, -0.8);
  AddHull(hull_centers_m, &sail);
  return sail;
}

Eigen::Vector3d InFrame(const ShapeFrame& frame, const Sail& sail, int marker_id) {
  return frame.frame_from_shape * *FindWholeMarker(sail.shape, marker_id)->x_in_shape_m[0];
}

void ExpectNear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double tolerance = 1e-12) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " instead of " << b.transpose();
}

TEST(ShapeFrame, EveryKindCanBeChosen) {
  const Sail sail = SailWithHull();
  const std::vector<std::pair<FrameChoice, std::string>> choices = {
      {{FrameKind::kMarkers, 100, 111, 300}, "markers 100 111 300"},
      {{FrameKind::kReferencePart}, "reference part hull"},
      {{FrameKind::kLines}, "lines h1 v1"},
      {{FrameKind::kCamera}, "camera"}};
  for (const auto& [choice, name] : choices) {
    const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout, choice);
    EXPECT_EQ(frame.name, name);
    EXPECT_TRUE(frame.reasons.empty());
    EXPECT_THAT(FrameText(frame), HasSubstr(frame.name + ": "));
    // A quaternion from a reflection would not have unit length.
    EXPECT_NEAR(frame.frame_from_shape.rotation.norm(), 1, 1e-12);
  }
}

TEST(ShapeFrame, ByMarkersPutsThemWhereTheyBelong) {
  Sail sail = SailWithHull();
  sail.shape = Moved(ArbitraryMotion(), sail.shape);
  const ShapeFrame frame =
      ChooseFrame(sail.shape, sail.layout, FrameChoice{FrameKind::kMarkers, 104, 111, 307});
  EXPECT_EQ(frame.name, "markers 104 111 307");
  ExpectNear(InFrame(frame, sail, 104), Eigen::Vector3d::Zero());
  const Eigen::Vector3d axis = InFrame(frame, sail, 111), plane = InFrame(frame, sail, 307);
  EXPECT_GT(axis.x(), 0);
  EXPECT_NEAR(axis.tail<2>().norm(), 0, 1e-12);
  EXPECT_NEAR(plane.y(), 0, 1e-12);
  EXPECT_GT(plane.z(), 0);
}

TEST(ShapeFrame, ByLinesHasTheOriginAtTheLuffOfTheFootAndZUp) {
  Sail sail = ExampleSail();
  const MarkerShape truth = sail.shape;  // built in this very frame
  sail.shape = Moved(ArbitraryMotion(), sail.shape);
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "lines h1 v1");
  EXPECT_THAT(frame.description, HasSubstr("y to leeward"));
  ASSERT_EQ(frame.reasons.size(), 1u);
  EXPECT_EQ(frame.reasons[0], "not by reference_part: the layout names no reference_part");
  for (const ShapeMarker& marker : truth.markers) {
    ExpectNear(InFrame(frame, sail, marker.marker_id), *marker.x_in_shape_m[0]);
  }
}

TEST(ShapeFrame, OnTheOtherTackYIsToWindwardAndSaysSo) {
  const Sail sail = ExampleSail(12, -1);
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_THAT(frame.description, HasSubstr("y to windward (the sail bulges to -y)"));
  EXPECT_LT(InFrame(frame, sail, 106).y(), 0);
  EXPECT_GT(InFrame(frame, sail, 300).z(), 0);
}

TEST(ShapeFrame, WithoutAVerticalLineTheHighestHorizontalOneGivesUp) {
  Sail sail = ExampleSail();
  sail.layout.parts[0].vertical.clear();
  sail.shape = Moved(ArbitraryMotion(), sail.shape);
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "lines h1 h3");
  EXPECT_GT(InFrame(frame, sail, 300).z(), 3.5);
  EXPECT_NEAR(InFrame(frame, sail, 111).tail<2>().norm(), 0, 1e-12);
}

TEST(ShapeFrame, ByTheHullDoesNotMoveWithTheSail) {
  Sail sail = SailWithHull();
  const ShapeFrame before = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(before.name, "reference part hull");
  // Along the strip, upright, origin at its middle.
  ExpectNear(InFrame(before, sail, 13), {0.75, 0, 0});
  EXPECT_GT(InFrame(before, sail, 300).z(), 4);
  // Sheeting out and twisting the sail does not change the hull's frame.
  const Rigid3 sheeted{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())),
                       {0, 0, 0.1}};
  for (ShapeMarker& marker : sail.shape.markers) {
    if (marker.part != "sail") continue;
    for (auto& x : marker.x_in_shape_m) x = sheeted * *x;
  }
  const ShapeFrame after = ChooseFrame(sail.shape, sail.layout);
  EXPECT_LT(AngularDistance(before.frame_from_shape, after.frame_from_shape), 1e-12);
  ExpectNear(before.frame_from_shape.translation, after.frame_from_shape.translation);
}

TEST(ShapeFrame, SameBoatInTwoClipsComparesDirectly) {
  const Sail sail = SailWithHull();
  Sail other = sail;
  other.shape = Moved(ArbitraryMotion(), sail.shape);
  for (const FrameChoice& choice :
       {FrameChoice{FrameKind::kMarkers, 10, 13, 300}, FrameChoice{FrameKind::kReferencePart},
        FrameChoice{FrameKind::kLines}}) {
    const ShapeFrame a = ChooseFrame(sail.shape, sail.layout, choice);
    const ShapeFrame b = ChooseFrame(other.shape, other.layout, choice);
    EXPECT_EQ(FrameText(a), FrameText(b));
    for (const ShapeMarker& marker : sail.shape.markers) {
      ExpectNear(InFrame(a, sail, marker.marker_id), InFrame(b, other, marker.marker_id), 1e-10);
    }
  }
}

TEST(ShapeFrame, DeckMarkersHaveTheirNormalUp) {
  Sail sail = SailWithHull();
  for (ShapeMarker& marker : sail.shape.markers) {
    if (marker.part != "hull") continue;
    const Eigen::Vector3d center = *marker.x_in_shape_m[0];
    const Rigid3 laid{
        Eigen::Quaterniond(Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d::Zero()};
    for (auto& x : marker.x_in_shape_m) x = center + laid * (*x - center);
  }
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_THAT(frame.description, HasSubstr("z up: the normal of its plane"));
  ExpectNear(InFrame(frame, sail, 13), {0.75, 0, 0});
  EXPECT_NEAR(InFrame(frame, sail, 300).z(), 4.8, 1e-9);
}

TEST(ShapeFrame, StripAroundACurvedSideIsAlignedByItsMarkersFacing) {
  // The part is about as thick as it is wide, so that noise would rotate its plane.
  Sail sail = SailWithHull();
  for (const int id : {11, 12}) ShiftMarker(id, {0, -0.1, 0}, &sail.shape);
  const ShapeFrame before = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(before.name, "reference part hull by its markers' facing");
  EXPECT_NEAR(InFrame(before, sail, 13).z(), InFrame(before, sail, 10).z(), 1e-12);
  EXPECT_NEAR(InFrame(before, sail, 300).z(), 4.8, 1e-9);
  ShiftMarker(11, {0.0003, -0.0003, 0.0003}, &sail.shape);
  const ShapeFrame after = ChooseFrame(sail.shape, sail.layout);
  EXPECT_LT(AngularDistance(before.frame_from_shape, after.frame_from_shape), 1e-3);
}

TEST(ShapeFrame, FallsBackInOrderAndSaysWhy) {
  Sail sail = SailWithHull();
  sail.layout.frame = FrameChoice{FrameKind::kMarkers, 100, 111, 305};
  RemoveMarker(111, &sail.shape);
  ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "reference part hull");
  ASSERT_EQ(frame.reasons.size(), 1u);
  EXPECT_EQ(frame.reasons[0], "not by markers 100 111 305: marker 111 was not reconstructed whole");

  for (const int id : {10, 11, 12}) RemoveMarker(id, &sail.shape);
  frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "lines h2 v1");  // another name, for it is another frame
  EXPECT_EQ(frame.reasons.size(), 2u);

  for (const int id : {200, 311}) RemoveMarker(id, &sail.shape);
  frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "camera");
  EXPECT_EQ(frame.reasons.size(), 3u);
  EXPECT_THAT(FrameText(frame), HasSubstr("no horizontal line has both its luff and its leech"));
  ExpectNear(InFrame(frame, sail, 100), Eigen::Vector3d::Zero());
}

TEST(ShapeFrame, AMissingHullMarkerIsInTheName) {
  Sail sail = SailWithHull();
  RemoveMarker(12, &sail.shape);
  EXPECT_EQ(ChooseFrame(sail.shape, sail.layout).name, "reference part hull without 12");
}

TEST(ShapeFrame, ContradictionsAreReasons) {
  Sail sail = ExampleSail();
  auto& ids = sail.layout.parts[0].vertical[0].marker_ids;
  std::reverse(ids.begin(), ids.end());
  EXPECT_THAT(FrameText(ChooseFrame(sail.shape, sail.layout)), HasSubstr("from foot to head"));

  sail.layout.frame = FrameChoice{FrameKind::kMarkers, 100, 200, 300};
  EXPECT_THAT(ChooseFrame(sail.shape, sail.layout).reasons[0], HasSubstr("lie on one line"));
}

TEST(ShapeFrame, AChoiceIsGrantedOrRefused) {
  const Sail sail = ExampleSail();
  const FrameChoice on_one_line{FrameKind::kMarkers, 100, 200, 300};
  ExpectThrows<InputError>(
      [&] { ChooseFrame(sail.shape, sail.layout, on_one_line); },
      {"--frame: the frame 'markers 100 200 300' is not possible: ", "lie on one line"});
  // Before the work, where the layout forbids it.
  ExpectThrows<InputError>(
      [&] {
        CheckFrameChoice(FrameChoice{FrameKind::kMarkers, 100, 200, 4711}, sail.layout);
      },
      {"--frame", "the layout names no marker 4711"});
  for (const FrameKind kind : {FrameKind::kReferencePart, FrameKind::kLines}) {
    ExpectThrows<InputError>(
        [&] { CheckFrameChoice(FrameChoice{kind}, MakeLayout("DICT_4X4_50", 0.1)); },
        {"--frame: the frame '" + FrameKeyword(kind) + "'", "the layout"});
  }
  CheckFrameChoice(on_one_line, sail.layout);
  CheckFrameChoice(on_one_line, MakeLayout("DICT_4X4_50", 0.1));
}

TEST(ShapeFrame, WithoutLayoutItIsTheCamera) {
  Sail sail = ExampleSail();
  sail.layout.parts.clear();
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  EXPECT_EQ(frame.name, "camera");
  EXPECT_FALSE(frame.up_in_frame);
}

// One marker whose corners share their errors, which differ between the axes.
PointCovariance MarkerCovariance(int marker_id, const Eigen::Matrix3d& own,
                                 const Eigen::Vector3d& shared) {
  PointCovariance covariance;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    covariance.point3D_ids.push_back(Point3DIdFromCorner({marker_id, corner}));
  }
  covariance.blocks = {Eigen::MatrixXd::Zero(12, 12)};
  for (int i = 0; i < 4; ++i) covariance.blocks[0].block<3, 3>(3 * i, 3 * i) = own;
  covariance.factor = shared.replicate(4, 1);
  covariance.signs = Eigen::VectorXd::Ones(1);
  return covariance;
}

TEST(ShapeFrame, SigmasTurnWithTheFullCovariance) {
  Eigen::Matrix3d own;
  own << 4, 1, 0.5, 1, 3, -0.7, 0.5, -0.7, 2;
  own *= 1e-6;
  const Eigen::Vector3d shared(1e-3, -2e-3, 3e-3);
  const PointCovariance covariance = MarkerCovariance(7, own, shared);
  const Rigid3 motion = ArbitraryMotion();
  const PointCovariance turned = RotateCovariance(motion.rotation, covariance);
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  const Eigen::Matrix3d expected =
      rotation * (own + shared * shared.transpose()) * rotation.transpose();
  EXPECT_LT((PointCovarianceOf(turned, Point3DIdFromCorner({7, 2})) - expected).norm(), 1e-18);

  MarkerShape shape;
  shape.markers = {UprightMarker(7, "sail", {1, 2, 3})};
  for (auto& sigma : shape.markers[0].sigma_m) {
    sigma = (own + shared * shared.transpose()).diagonal().cwiseSqrt();
  }
  MarkerShape with = shape, without = shape, round = shape;
  MoveShape(motion, &turned, &with);
  ExpectNear(*with.markers[0].sigma_m[2], expected.diagonal().cwiseSqrt(), 1e-12);
  MoveShape(motion, nullptr, &without);
  EXPECT_FALSE(without.markers[0].sigma_m[2]);
  SetSigma(0.002, &round);
  MoveShape(motion, nullptr, &round);
  ExpectNear(*round.markers[0].sigma_m[2], Eigen::Vector3d::Constant(0.002));
  // A translation does not change sigmas.
  MoveShape({Eigen::Quaterniond::Identity(), {1, 1, 1}}, nullptr, &shape);
  EXPECT_TRUE(shape.markers[0].sigma_m[2]);
}

}  // namespace
}  // namespace velamap
