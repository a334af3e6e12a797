#include "exporters/sail/section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/shape/shape_transform.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::HasSubstr;

// Sections in the default frame of the layout.
SectionReport Sections(const Sail& sail, const SectionOptions& options = {},
                       const std::optional<FrameChoice>& choice = std::nullopt) {
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout, choice);
  MarkerShape shape = sail.shape;
  MoveShape(frame.frame_from_shape, nullptr, &shape);
  return ComputeSections(shape, frame, sail.layout, nullptr, options);
}

std::vector<double> Numbers(const Section& section) {
  return {section.chord_m.value,
          section.camber.value,
          section.draft_position ? section.draft_position->value : -1,
          section.entry_angle_deg.value,
          section.exit_angle_deg.value,
          section.twist_deg.value,
          section.leech_twist_deg.value,
          section.girth_m.value,
          section.height_m};
}

void ExpectSameNumbers(const SectionReport& a, const SectionReport& b, double tolerance) {
  ASSERT_EQ(a.sections.size(), b.sections.size());
  for (std::size_t i = 0; i < a.sections.size(); ++i) {
    const auto numbers_a = Numbers(a.sections[i]), numbers_b = Numbers(b.sections[i]);
    EXPECT_EQ(a.sections[i].name, b.sections[i].name);
    for (std::size_t k = 0; k < numbers_a.size(); ++k) {
      EXPECT_NEAR(numbers_a[k], numbers_b[k], tolerance) << a.sections[i].name << " number " << k;
    }
  }
}

TEST(Section, CircularArcsGiveTheirCamberAnglesAndTwist) {
  const SectionReport report = Sections(ExampleSail());
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_TRUE(report.missing.empty());
  EXPECT_TRUE(report.notes.empty());
  EXPECT_EQ(report.twist_reference, "lowest section");
  const std::vector<double> chords_m = {3.0, 2.4, 1.6}, cambers = {0.08, 0.10, 0.12};
  const std::vector<double> twists_deg = {0, 6, 14};
  for (std::size_t i = 0; i < 3; ++i) {
    const Section& section = report.sections[i];
    const double angle_deg = 2 * std::atan(2 * cambers[i]) * kDegPerRad;
    EXPECT_NEAR(section.chord_m.value, chords_m[i], 1e-5);
    EXPECT_NEAR(section.camber.value, cambers[i], 1e-5);
    EXPECT_NEAR(section.draft_position->value, 0.5, 1e-5);
    EXPECT_NEAR(section.entry_angle_deg.value, angle_deg, 0.03);
    EXPECT_NEAR(section.exit_angle_deg.value, angle_deg, 0.03);
    EXPECT_NEAR(section.twist_deg.value, twists_deg[i], 1e-5);
    const double radius_m = chords_m[i] / (2 * std::sin(angle_deg * kRadPerDeg));
    EXPECT_NEAR(section.girth_m.value, 2 * radius_m * angle_deg * kRadPerDeg, 1e-5);
    const double lowest_angle_deg = 2 * std::atan(2 * cambers[0]) * kDegPerRad;
    EXPECT_NEAR(section.leech_twist_deg.value, twists_deg[i] - angle_deg + lowest_angle_deg, 0.05);
    EXPECT_NEAR(section.height_m, 2.0 * i, 1e-9);
    EXPECT_EQ(section.markers.size(), 12u);
    EXPECT_FALSE(section.camber.sigma);
  }
}

TEST(Section, NacaCamberLineGivesDraftPositionAndUnequalAngles) {
  const double camber = 0.12, position = 0.4;
  const SectionReport report = Sections(MakeSailOfLines(
      {{0, 2, 0, NacaCamberLine(camber, position)}, {1, 2, 0, NacaCamberLine(camber, position)}},
      21));
  ASSERT_EQ(report.sections.size(), 2u);
  const Section& section = report.sections[0];
  EXPECT_NEAR(section.camber.value, camber, 2e-4);
  EXPECT_NEAR(section.draft_position->value, position, 0.008);
  EXPECT_NEAR(section.entry_angle_deg.value, std::atan(2 * camber / position) * kDegPerRad, 0.3);
  EXPECT_NEAR(section.exit_angle_deg.value, std::atan(2 * camber / (1 - position)) * kDegPerRad,
              0.3);
}

TEST(Section, StraightTwistedLinesHaveTwistAndNoDraftPosition) {
  const SectionReport report = Sections(MakeSailOfLines(
      {{0, 2, 0, CircularArc(0)}, {1, 1.5, -5, CircularArc(0)}, {2, 1, 21, CircularArc(0)}}, 5));
  ASSERT_EQ(report.sections.size(), 3u);
  for (const Section& section : report.sections) {
    EXPECT_NEAR(section.camber.value, 0, 1e-9);
    EXPECT_NEAR(section.entry_angle_deg.value, 0, 1e-5);
    EXPECT_FALSE(section.draft_position);
  }
  // A flat sail has no leeward side; the sign is that of +y or -y.
  EXPECT_NEAR(std::abs(report.sections[1].twist_deg.value), 5, 1e-6);
  EXPECT_NEAR(report.sections[2].twist_deg.value / report.sections[1].twist_deg.value, -4.2, 1e-6);
}

TEST(Section, OtherTackGivesTheSameNumbers) {
  ExpectSameNumbers(Sections(ExampleSail(12, 1)), Sections(ExampleSail(12, -1)), 1e-9);
}

TEST(Section, RigidMotionChangesNoNumber) {
  Sail moved = ExampleSail();
  SetSigma(0.002, &moved.shape);
  const SectionOptions options{{1.0, 3.0}};
  const SectionReport before = Sections(moved, options);
  moved.shape = Moved(OddMotion(), moved.shape);
  const SectionReport after = Sections(moved, options);
  ASSERT_EQ(before.sections.size(), 5u);
  ExpectSameNumbers(before, after, 1e-7);
  for (std::size_t i = 0; i < before.sections.size(); ++i) {
    EXPECT_NEAR(*before.sections[i].camber.sigma, *after.sections[i].camber.sigma, 1e-8);
  }
}

TEST(Section, OrderOfMarkersInTheShapeAndOfLinesInTheLayoutDoesNotMatter) {
  Sail sail = ExampleSail();
  const SectionReport before = Sections(sail);
  // Permutes the ids, because the markers of a shape are sorted.
  for (ShapeMarker& marker : sail.shape.markers) marker.marker_id = 1000 - marker.marker_id;
  std::reverse(sail.shape.markers.begin(), sail.shape.markers.end());
  LayoutPart& part = sail.layout.parts[0];
  for (auto* lines : {&part.horizontal, &part.vertical}) {
    for (MarkerLine& line : *lines) {
      for (int& id : line.marker_ids) id = 1000 - id;
    }
  }
  ExpectSameNumbers(before, Sections(sail), 1e-12);
  // In a frame by markers, the order of the lines does not matter.
  const FrameChoice choice{FrameKind::kMarkers, 900, 889, 700};
  const SectionReport by_markers = Sections(sail, {}, choice);
  std::reverse(part.horizontal.begin(), part.horizontal.end());
  ExpectSameNumbers(by_markers, Sections(sail, {}, choice), 1e-12);
}

TEST(Section, CameraFrameGivesTheSameNumbersButHeights) {
  Sail sail = ExampleSail();
  const SectionReport by_lines = Sections(sail);
  sail.shape = Moved(OddMotion(), sail.shape);
  const SectionReport by_camera = Sections(sail, {}, FrameChoice{FrameKind::kCamera});
  ASSERT_EQ(by_camera.sections.size(), by_lines.sections.size());
  for (std::size_t i = 0; i < by_lines.sections.size(); ++i) {
    const auto a = Numbers(by_lines.sections[i]), b = Numbers(by_camera.sections[i]);
    for (std::size_t k = 0; k + 1 < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-7);
  }
}

// A hull with flared topsides stands at an angle to the mast, and so does its frame to the others.
TEST(Section, NumbersDoNotDependOnTheFrame) {
  Sail sail = ExampleSail();
  // A mast that is bent, so that no two of its markers give its direction, and lines that rise.
  for (ShapeMarker& marker : sail.shape.markers) {
    for (auto& x : marker.x_in_shape_m) {
      x->x() -= 0.02 * x->z() * (4 - x->z());
      x->z() += 0.1 * x->x();
    }
  }
  const Eigen::Quaterniond flare(
      Eigen::AngleAxisd(0.35, Eigen::Vector3d(1, 0.2, 0.1).normalized()));
  std::vector<Eigen::Vector3d> hull_centers_m;
  for (int i = 0; i < 6; ++i) {
    hull_centers_m.push_back(flare * Eigen::Vector3d(0.5 * (i / 2), 0, -1.0 - i % 2));
  }
  AddHull(hull_centers_m, &sail);
  const SectionReport by_hull = Sections(sail, {}, FrameChoice{FrameKind::kReferencePart});
  EXPECT_EQ(by_hull.up_reference, "luff");
  const ShapeFrame hull_frame = ChooseFrame(sail.shape, sail.layout, std::nullopt);
  const Eigen::Vector3d hull_up =
      hull_frame.frame_from_shape.rotation.conjugate() * *hull_frame.up_in_frame;
  EXPECT_LT(hull_up.z(), std::cos(15 * kRadPerDeg));
  for (const FrameChoice& choice : {FrameChoice{FrameKind::kLines}, FrameChoice{FrameKind::kCamera},
                                    FrameChoice{FrameKind::kMarkers, 11, 15, 10},
                                    FrameChoice{FrameKind::kMarkers, 10, 11, 14}}) {
    const SectionReport report = Sections(sail, {}, choice);
    ASSERT_EQ(report.sections.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = Numbers(by_hull.sections[i]), b = Numbers(report.sections[i]);
      for (std::size_t k = 0; k + 1 < a.size(); ++k) {
        EXPECT_NEAR(a[k], b[k], 1e-9) << by_hull.sections[i].name << " number " << k;
      }
    }
  }
}

TEST(Section, NegativeCamberIsToWindwardOfTheWholeSail) {
  const Sail sail = MakeSailOfLines(
      {{0, 3, 0, CircularArc(0.1)}, {2, 2, 0, CircularArc(0.1)}, {4, 1, 0, CircularArc(-0.03)}}, 9);
  const SectionReport report = Sections(sail);
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_NEAR(report.sections[0].camber.value, 0.1, 1e-4);
  EXPECT_NEAR(report.sections[2].camber.value, -0.03, 1e-4);
  EXPECT_LT(report.sections[2].entry_angle_deg.value, 0);
}

TEST(Section, TwistCountsFromTheBoomWhereTheLayoutHasOne) {
  Sail sail = ExampleSail();
  // 4 degrees to windward of the lowest chord, listed from its end forwards.
  const Eigen::Vector3d aft(std::cos(4 / kDegPerRad), -std::sin(4 / kDegPerRad), 0);
  for (const auto& [id, distance_m] :
       {std::pair(51, 2.5), std::pair(52, 1.5), std::pair(53, 0.2)}) {
    sail.shape.markers.insert(
        sail.shape.markers.begin() + (id - 51),
        UprightMarker(id, "boom", distance_m * aft - Eigen::Vector3d(0, 0, 0.3)));
  }
  LayoutPart boom;
  boom.name = "boom";
  boom.marker_ids = {51, 52, 53};
  sail.layout.parts.push_back(boom);
  SetSigma(0.001, &sail.shape);
  SectionReport report = Sections(sail);
  EXPECT_EQ(report.twist_reference, "boom");
  EXPECT_NEAR(report.sections[0].twist_deg.value, 4, 1e-3);
  EXPECT_NEAR(report.sections[2].twist_deg.value, 18, 1e-3);
  EXPECT_GT(*report.sections[0].twist_deg.sigma, 0);

  RemoveMarker(51, &sail.shape);
  RemoveMarker(52, &sail.shape);
  report = Sections(sail);
  EXPECT_EQ(report.twist_reference, "lowest section");
  EXPECT_NEAR(report.sections[0].twist_deg.value, 0, 1e-12);
  EXPECT_EQ(*report.sections[0].twist_deg.sigma, 0);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("boom"));
}

TEST(Section, HeightsBetweenLinesOfOneShapeGiveThatShape) {
  // A cylinder of constant section: every height has the same numbers.
  const Sail sail = MakeSailOfLines({{0, 2, 0, CircularArc(0.1)},
                                     {1, 2, 0, CircularArc(0.1)},
                                     {2.5, 2, 0, CircularArc(0.1)},
                                     {3, 2, 0, CircularArc(0.1)}},
                                    10);
  const SectionReport report = Sections(sail, {{2.0, 0.5, 3.0, 0.5, 3.2}});
  ASSERT_EQ(report.sections.size(), 7u);  // 0, 0.5, 1, 2, 2.5, 3 and the height 3
  for (const Section& section : report.sections) {
    EXPECT_NEAR(section.camber.value, 0.1, 1e-5) << section.name;
    EXPECT_NEAR(section.chord_m.value, 2, 2e-5);
    EXPECT_NEAR(section.entry_angle_deg.value, 2 * std::atan(0.2) * kDegPerRad, 0.05);
  }
  EXPECT_EQ(report.sections[1].name, "z=0.5");
  EXPECT_FALSE(report.sections[1].is_line);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].name, "z=3.2");
  EXPECT_THAT(report.missing[0].reason, HasSubstr("from 0.000 to 3.000 m"));
}

TEST(Section, NeighbouringHeightsHaveNamesOfTheirOwn) {
  const SectionReport report = Sections(ExampleSail(), {{1.0, 1.0000001}});
  ASSERT_EQ(report.sections.size(), 5u);
  EXPECT_EQ(report.sections[1].name, "z=1");
  EXPECT_EQ(report.sections[2].name, "z=1.0000001");
}

TEST(Section, HeightOnASlopingSailIsLevel) {
  // The cut through lines that rise towards the leech is horizontal.
  Sail sail = ExampleSail();
  for (ShapeMarker& marker : sail.shape.markers) {
    for (auto& x : marker.x_in_shape_m) x->z() += 0.1 * x->x();
  }
  const SectionReport report = Sections(sail, {{1.5}}, FrameChoice{FrameKind::kCamera});
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout, FrameChoice{FrameKind::kCamera});
  ASSERT_TRUE(frame.up_in_frame);
  const auto cut = std::find_if(report.sections.begin(), report.sections.end(),
                                [](const Section& section) { return !section.is_line; });
  ASSERT_NE(cut, report.sections.end());
  for (const ProfilePoint& point : SampleProfile(*cut, 20)) {
    EXPECT_NEAR(frame.up_in_frame->dot(point.x_in_frame_m), 1.5, 1e-5);
  }
}

// Compares standard deviations with the scatter of the numbers under such noise.
TEST(Section, SigmasAgreeWithMonteCarlo) {
  constexpr double kSigma_m = 0.003;
  constexpr int kNumRuns = 50;
  Sail sail = ExampleSail(8);
  SetSigma(kSigma_m, &sail.shape);
  const FrameChoice camera{FrameKind::kCamera};
  const SectionOptions options{{1.2}};
  const SectionReport stated = Sections(sail, options, camera);
  ASSERT_EQ(stated.sections.size(), 4u);
  const auto numbers = [](const SectionReport& report, std::size_t i) {
    Eigen::Matrix<double, 6, 1> values;
    for (int k = 0; k < 6; ++k)
      values[k] = Numbers(report.sections[i])[static_cast<std::size_t>(k)];
    return values;
  };
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kSigma_m);
  std::vector<Eigen::Matrix<double, 6, 1>> sums(4, Eigen::Matrix<double, 6, 1>::Zero()),
      squares = sums;
  for (int run = 0; run < kNumRuns; ++run) {
    Sail noisy = sail;
    for (ShapeMarker& marker : noisy.shape.markers) {
      const Eigen::Vector3d shift(noise(random), noise(random), noise(random));
      ShiftMarker(marker.marker_id, shift, &noisy.shape);
    }
    const SectionReport report = Sections(noisy, options, camera);
    ASSERT_EQ(report.sections.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto difference = (numbers(report, i) - numbers(stated, i)).eval();
      sums[i] += difference;
      squares[i] += difference.cwiseAbs2();
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Section& section = stated.sections[i];
    const std::vector<double> sigmas = {
        *section.chord_m.sigma,         *section.camber.sigma,
        *section.draft_position->sigma, *section.entry_angle_deg.sigma,
        *section.exit_angle_deg.sigma,  *section.twist_deg.sigma};
    for (int k = 0; k < 6; ++k) {
      if (i == 0 && k == 5) continue;  // the lowest section's twist is 0 by definition
      const double spread = std::sqrt(squares[i][k] / kNumRuns);
      EXPECT_NEAR(spread / sigmas[static_cast<std::size_t>(k)], 1, 0.3)
          << section.name << " number " << k;
    }
  }
}

TEST(Section, JointCovarianceLetsSharedErrorsCancel) {
  // A common error of all corners of 10 mm, and an individual one of each marker of 1 mm.
  Sail sail = ExampleSail(8);
  PointCovariance covariance;
  for (const ShapeMarker& marker : sail.shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      covariance.point3D_ids.push_back(Point3DIdFromCorner({marker.marker_id, corner}));
    }
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(12, 12);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        block.block<3, 3>(3 * i, 3 * j) = 1e-6 * Eigen::Matrix3d::Identity();
      }
    }
    covariance.blocks.push_back(block);
  }
  const auto num_points = static_cast<Eigen::Index>(covariance.point3D_ids.size());
  covariance.factor = 0.01 * Eigen::Matrix3d::Identity().replicate(num_points, 1);
  covariance.signs = Eigen::VectorXd::Ones(3);

  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  SetSigma(0.001, &sail.shape);
  const SectionReport own = ComputeSections(sail.shape, frame, sail.layout, nullptr);
  const SectionReport joint = ComputeSections(sail.shape, frame, sail.layout, &covariance);
  SetSigma(0.01, &sail.shape);
  const SectionReport apart = ComputeSections(sail.shape, frame, sail.layout, nullptr);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(*joint.sections[i].camber.sigma / *own.sections[i].camber.sigma, 1, 0.05);
    EXPECT_NEAR(*joint.sections[i].chord_m.sigma / *own.sections[i].chord_m.sigma, 1, 0.05);
    EXPECT_GT(*apart.sections[i].chord_m.sigma, 5 * *joint.sections[i].chord_m.sigma);
  }
}

TEST(Section, NoiseIsSmoothedByItsSigma) {
  Sail sail = ExampleSail(15);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.004);
  for (ShapeMarker& marker : sail.shape.markers) {
    ShiftMarker(marker.marker_id, {noise(random), noise(random), noise(random)}, &sail.shape);
  }
  const auto rms_angle_error = [&](double sigma_m) {
    SetSigma(sigma_m, &sail.shape);
    double sum = 0;
    const SectionReport report = Sections(sail);
    const std::vector<double> cambers = {0.08, 0.10, 0.12};
    for (std::size_t i = 0; i < 3; ++i) {
      const double truth_deg = 2 * std::atan(2 * cambers[i]) * kDegPerRad;
      sum += std::pow(report.sections[i].entry_angle_deg.value - truth_deg, 2) +
             std::pow(report.sections[i].exit_angle_deg.value - truth_deg, 2);
    }
    return std::sqrt(sum / 6);
  };
  EXPECT_LT(rms_angle_error(0.004), 0.6 * rms_angle_error(1e-6));
}

TEST(Section, LineWithTooFewMarkersIsLeftOutWithTheReason) {
  Sail sail = ExampleSail(5);
  RemoveMarker(201, &sail.shape);
  RemoveMarker(203, &sail.shape);
  const SectionReport report = Sections(sail);
  ASSERT_EQ(report.sections.size(), 2u);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].name, "h2");
  EXPECT_EQ(report.missing[0].reason, "3 of its 5 markers are reconstructed whole; 4 are needed");
  EXPECT_FALSE(report.missing[0].is_by_layout);
}

TEST(Section, LineThatTheLayoutMakesTooShortIsNoFaultOfTheClip) {
  Sail sail = ExampleSail(5);
  sail.layout.parts[0].horizontal[1].marker_ids.resize(3);
  const SectionReport report = Sections(sail);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].reason, "the layout gives it 3 markers; 4 are needed");
  EXPECT_TRUE(report.missing[0].is_by_layout);
}

TEST(Section, BadLinesAreLeftOutWithTheReason) {
  const auto reason = [](const Sail& sail) {
    const SectionReport report = Sections(sail);
    EXPECT_EQ(report.sections.size(), 2u);
    return report.missing.size() == 1 ? report.missing[0].reason : "none";
  };
  Sail reversed = ExampleSail();
  auto& reversed_ids = reversed.layout.parts[0].horizontal[1].marker_ids;
  std::reverse(reversed_ids.begin(), reversed_ids.end());
  EXPECT_THAT(reason(reversed), HasSubstr("from luff to leech"));

  Sail mixed = ExampleSail();
  std::swap(mixed.layout.parts[0].horizontal[2].marker_ids[3],
            mixed.layout.parts[0].horizontal[2].marker_ids[7]);
  EXPECT_THAT(reason(mixed), HasSubstr("marker 304 is not aft of marker 307"));

  Sail double_marker = ExampleSail();
  ShiftMarker(205,
              *double_marker.shape.markers[12 + 4].x_in_shape_m[0] -
                  *double_marker.shape.markers[12 + 5].x_in_shape_m[0],
              &double_marker.shape);
  EXPECT_THAT(reason(double_marker), HasSubstr("markers 204 and 205 are in the same place"));
}

std::vector<std::string> NamesOf(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections) names.push_back(section.name);
  return names;
}

TEST(Section, NeitherOfTwoSectionsThatCrossIsPrinted) {
  Sail sail = ExampleSail();
  for (int j = 6; j < 12; ++j) ShiftMarker(200 + j, {0, 0, -0.45 * (j - 5)}, &sail.shape);
  const SectionReport report = Sections(sail, {{1.0}});
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h3"));
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("sections h1 and h2 cross: at 100 % of their length"));
  EXPECT_THAT(report.notes[0], HasSubstr("h1 and h2 left out"));
  ASSERT_EQ(report.missing.size(), 3u);
  EXPECT_THAT(report.missing[0].reason, HasSubstr("h1 and h2 cross"));
  EXPECT_THAT(report.missing[1].reason, HasSubstr("h1 and h2 cross"));
  EXPECT_THAT(report.missing[2].reason, HasSubstr("fewer than two lines"));
}

TEST(Section, OnlyTheSectionThatCrossesTheOthersIsLeftOut) {
  Sail sail = ExampleSail();
  for (int j = 0; j < 12; ++j) ShiftMarker(200 + j, {0, 0, 0.9 * (j - 5)}, &sail.shape);
  const SectionReport report = Sections(sail, {{1.0}});
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h1", "z=1", "h3"));
  ASSERT_EQ(report.notes.size(), 2u);
  EXPECT_THAT(report.notes[0], HasSubstr("h2 left out"));
  EXPECT_THAT(report.notes[1], HasSubstr("h2 left out"));
}

TEST(Section, SectionInTheOrderOfNoLayoutIsLeftOut) {
  Sail sail = ExampleSail();
  auto& lines = sail.layout.parts[0].horizontal;
  std::reverse(lines.begin(), lines.end());  // head to foot
  EXPECT_EQ(Sections(sail).sections.size(), 3u);
  std::swap(lines[0], lines[1]);
  const SectionReport report = Sections(sail);
  EXPECT_THAT(NamesOf(report.sections), testing::ElementsAre("h1"));
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("h2 and h3 are in the wrong order"));
}

TEST(Section, LayoutWithoutLinesIsSaidOnce) {
  Sail sail = ExampleSail();
  sail.layout.parts.clear();
  const SectionReport report = Sections(sail, {{1.0, 2.0}});
  EXPECT_TRUE(report.sections.empty());
  EXPECT_TRUE(report.missing.empty());
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("no horizontal lines"));
}

TEST(Section, SigmasNeedAllMarkersOfTheSection) {
  Sail sail = ExampleSail();
  SetSigma(0.001, &sail.shape);
  sail.shape.markers[14].sigma_m[0].reset();  // on h2
  const SectionReport report = Sections(sail);
  EXPECT_TRUE(report.sections[0].camber.sigma);
  EXPECT_FALSE(report.sections[1].camber.sigma);
  EXPECT_FALSE(report.sections[1].twist_deg.sigma);
  EXPECT_TRUE(report.sections[2].twist_deg.sigma);
}

TEST(Section, BadOptionsAreRefused) {
  EXPECT_THROW((SectionOptions{{std::numeric_limits<double>::quiet_NaN()}}.Check()), InputError);
  EXPECT_THROW((SectionOptions{{}, 3}.Check()), InputError);
  EXPECT_THROW((SectionOptions{std::vector<double>(501, 1.0)}.Check()), InputError);
}

}  // namespace
}  // namespace velamap
