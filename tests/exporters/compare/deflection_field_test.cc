// Vectors from the surface of a reference to that of a shape.

#include "exporters/compare/deflection_field.h"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/shape_deviation.h"
#include "importer/text/csv.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/example_covariance.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kNumPoints = 21;

GridOptions Grid() { return {kNumPoints, kNumPoints}; }

AlignmentOptions WithMethod(AlignmentMethod method) {
  AlignmentOptions options;
  options.method = method;
  return options;
}

DeflectionReport ReportOf(const ShapeDeviation& deviation, const UncertainShape& shape,
                          const UncertainShape& reference, const GridOptions& grid) {
  return ComputeDeflections(
      deviation.alignment, {ShapeSurfaces(deviation.aligned_shape), shape.covariance},
      {ShapeSurfaces(reference.shape), reference.covariance}, BoatLayout(), grid);
}

// Both in one frame, with the sigmas of the shapes.
DeflectionReport ReportOf(const MarkerShape& shape, const MarkerShape& reference) {
  const UncertainShape uncertain = WithSigmas(shape), uncertain_reference = WithSigmas(reference);
  return ReportOf(CompareWithShape(uncertain, uncertain_reference, BoatLayout(),
                                   WithMethod(AlignmentMethod::kNone)),
                  uncertain, uncertain_reference, Grid());
}

DeflectionField FieldOf(const MarkerShape& shape, const MarkerShape& reference) {
  return ReportOf(shape, reference).fields.at(0);
}

// The sail only, in the frame of the design.
DeflectionReport ReportFrom(const MeshDistance& design, const MarkerShape& shape,
                            double design_sigma_m = 0.0) {
  const UncertainShape uncertain = WithSigmas(shape);
  const ShapeDeviation deviation =
      CompareWithMesh(uncertain, design, BoatLayout(), WithMethod(AlignmentMethod::kNone), "sail",
                      {}, design_sigma_m);
  return ComputeDeflections(deviation,
                            {ShapeSurfaces(deviation.aligned_shape), uncertain.covariance}, design,
                            BoatLayout(), Grid());
}

double LargestVector(const DeflectionField& field) {
  double largest_m = 0.0;
  for (const auto& deflection : field.deflections) {
    if (deflection) largest_m = std::max(largest_m, deflection->vector_m.norm());
  }
  return largest_m;
}

// The depth of a wide bump in the middle of the sail, m.
double Bump(const Eigen::Vector3d& x_m) {
  const Eigen::Vector3d from_middle = x_m - Eigen::Vector3d(1.3, 0.4, 2.0);
  return 0.03 * std::exp(-from_middle.squaredNorm() / (2 * 1.2 * 1.2));
}

MarkerShape WithBump(const MarkerShape& shape) {
  MarkerShape bumped = shape;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.part != "sail") continue;
    bumped =
        Shifted({marker.marker_id}, Bump(*marker.x_in_shape_m[0]) * MarkerNormal(marker), bumped);
  }
  return bumped;
}

TEST(Deflections, OfAShapeFromItselfAreZero) {
  const MarkerShape boat = BoatShape(0.001);
  const DeflectionField field = FieldOf(boat, boat);
  EXPECT_EQ(field.part, "sail");
  ASSERT_EQ(field.deflections.size(), static_cast<std::size_t>(kNumPoints * kNumPoints));
  for (const auto& deflection : field.deflections) {
    ASSERT_TRUE(deflection.has_value());
    EXPECT_EQ(deflection->vector_m.norm(), 0.0);
    ASSERT_TRUE(deflection->sigma_m.has_value());
    EXPECT_GT(*deflection->sigma_m, 0.0);
  }
}

TEST(Deflections, OfAShapeMovedRigidlyAreZeroAfterTheBestFit) {
  const MarkerShape boat = BoatShape(0.001);
  AlignmentOptions best_fit;
  best_fit.method = AlignmentMethod::kBestFit;
  const ShapeDeviation deviation =
      CompareWithShape({Moved(FarPose(), boat), {}}, {boat, {}}, BoatLayout(), best_fit);
  EXPECT_LT(LargestVector(FieldOf(deviation.aligned_shape, boat)), 1e-9);
}

// A best fit is exact to the rounding of coordinates of metres, which is not to be seen in a table.
TEST(Deflections, RoundingIsZero) {
  const MarkerShape boat = BoatShape(0.001);
  AlignmentOptions best_fit;
  best_fit.method = AlignmentMethod::kBestFit;
  const ShapeDeviation deviation =
      CompareWithShape({Moved(FarPose(), boat), {}}, {boat, {}}, BoatLayout(), best_fit);
  double rounding_m = 0.0;
  for (std::size_t i = 0; i < boat.markers.size(); ++i) {
    rounding_m +=
        (*deviation.aligned_shape.markers[i].x_in_shape_m[0] - *boat.markers[i].x_in_shape_m[0])
            .norm();
  }
  ASSERT_GT(rounding_m, 0.0) << "the example is exact";
  EXPECT_EQ(LargestVector(FieldOf(deviation.aligned_shape, boat)), 0.0);
  // What can be measured stays.
  const Eigen::Vector3d shift_m(0, 1e-6, 0);
  EXPECT_GT(LargestVector(FieldOf(Shifted(IdsOf("sail"), shift_m, boat), boat)), 0.9e-6);
}

TEST(Deflections, FollowTheMotionOfTheCloth) {
  const Eigen::Vector3d motion(0.02, 0.03, -0.01);
  const MarkerShape boat = BoatShape(0.001);
  const DeflectionField field = FieldOf(Shifted(IdsOf("sail"), motion, boat), boat);
  for (std::size_t i = 0; i < field.deflections.size(); ++i) {
    EXPECT_LT((field.deflections[i]->vector_m - motion).norm(), 1e-9);
    EXPECT_NEAR(field.deflections[i]->distance_m, motion.dot(field.reference.normals[i]), 1e-9);
  }
}

// A marker that one of the shapes lacks does not shift the cloth along its line.
TEST(Deflections, AMarkerAtTheEndThatOneShapeLacksDoesNotMatter) {
  const MarkerShape boat = BoatShape();
  MarkerShape without = boat;
  without.markers.erase(without.markers.begin() + 5);  // marker 16, at the leech of h1
  EXPECT_EQ(LargestVector(FieldOf(without, boat)), 0.0);
  EXPECT_EQ(LargestVector(FieldOf(boat, without)), 0.0);
}

TEST(Deflections, GiveAKnownBumpBackWithinSigmas) {
  const MarkerShape boat = BoatShape(0.001), bumped = WithBump(boat);
  const PointCovariance covariance = CovarianceFromSigmas(boat);
  double sum_of_squares = 0.0;
  int count = 0, num_far = 0;
  SampleShapes(bumped, covariance, 10, [&](const MarkerShape& shape) {
    SampleShapes(boat, covariance, 1, [&](const MarkerShape& reference) {
      const DeflectionField field = FieldOf(shape, reference);
      for (std::size_t i = 0; i < field.deflections.size(); ++i) {
        const double error_m =
            field.deflections[i]->distance_m - Bump(field.reference.vertices_m[i]);
        const double in_sigmas = error_m / *field.deflections[i]->sigma_m;
        sum_of_squares += in_sigmas * in_sigmas;
        num_far += std::abs(in_sigmas) > 3 ? 1 : 0;
        ++count;
      }
    });
  });
  const double rms_in_sigmas = std::sqrt(sum_of_squares / count);
  EXPECT_GT(rms_in_sigmas, 0.6);
  EXPECT_LT(rms_in_sigmas, 1.3);
  EXPECT_LT(num_far, 0.02 * count);
  // The bump is far above the noise.
  EXPECT_NEAR(LargestVector(FieldOf(bumped, boat)), 0.03, 0.002);
}

// Errors that markers share, here of the size of a shape, and the rotation that the noise of the
// hull gives to the sail above it: at the head, both are far larger than the noise of a marker.
TEST(Deflections, SigmasAreWhatRepetitionsScatterBy) {
  const MarkerShape boat = BoatShape(0.001);
  UncertainShape uncertain = WithSigmas(boat);
  uncertain.covariance.factor.resize(uncertain.covariance.factor.rows(), 1);
  uncertain.covariance.signs = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < uncertain.covariance.point3D_ids.size(); ++i) {
    const CornerId id = CornerFromPoint3DId(uncertain.covariance.point3D_ids[i]);
    uncertain.covariance.factor.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) =
        1e-3 * *FindMarker(boat, id.marker_id)->x_in_shape_m[static_cast<std::size_t>(id.corner)];
  }
  const ShapeSurfaces of_boat(boat);
  const auto field_of = [&](const UncertainShape& shape, const UncertainShape& reference) {
    const ShapeDeviation deviation = CompareWithShape(shape, reference, BoatLayout(), {});
    return ComputeDeflections(deviation.alignment,
                              {ShapeSurfaces(deviation.aligned_shape), shape.covariance},
                              {of_boat, reference.covariance}, BoatLayout(), {5, 5})
        .fields.at(0);
  };
  const DeflectionField field = field_of(uncertain, uncertain);
  std::vector<std::vector<double>> distances_m(field.deflections.size());
  SampleShapes(boat, uncertain.covariance, 100, [&](const MarkerShape& sample) {
    const DeflectionField sampled = field_of({sample, {}}, {boat, {}});
    for (std::size_t i = 0; i < distances_m.size(); ++i) {
      distances_m[i].push_back(sampled.deflections[i]->distance_m);
    }
  });
  double predicted = 0.0, sampled = 0.0;
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    // The reference scatters as much as the shape.
    const double sampled_m = std::sqrt(2.0) * ComputeStatistics(distances_m[i]).standard_deviation;
    EXPECT_NEAR(*field.deflections[i]->sigma_m / sampled_m, 1.0, 0.2) << i;
    predicted += std::pow(*field.deflections[i]->sigma_m, 2);
    sampled += std::pow(sampled_m, 2);
  }
  EXPECT_NEAR(std::sqrt(predicted / sampled), 1.0, 0.1);
  EXPECT_GT(*field.deflections.back()->sigma_m, 2 * *field.deflections.front()->sigma_m);
}

TEST(Deflections, HaveNoSigmaWhereTheMarkersHaveNone) {
  const MarkerShape boat = BoatShape(0.001);
  MarkerShape partly = boat;
  partly.markers.back().sigma_m = {};  // a marker of the hull, by which they are aligned
  const UncertainShape uncertain = WithSigmas(partly);
  const ShapeDeviation deviation = CompareWithShape(uncertain, WithSigmas(boat), BoatLayout(), {});
  ASSERT_EQ(deviation.num_with_sigma, 0);
  const DeflectionField field =
      ReportOf(deviation, uncertain, WithSigmas(boat), Grid()).fields.at(0);
  for (const auto& deflection : field.deflections) EXPECT_FALSE(deflection->sigma_m.has_value());
}

TEST(Deflections, TheSigmaOfADesignAddsToThatOfTheSail) {
  const MeshDistance design(SailMesh());
  const DeflectionField exact = ReportFrom(design, BoatShape(0.001)).fields.at(0);
  const DeflectionField uncertain = ReportFrom(design, BoatShape(0.001), 0.002).fields.at(0);
  for (std::size_t i = 0; i < exact.deflections.size(); ++i) {
    EXPECT_NEAR(*uncertain.deflections[i]->sigma_m,
                std::hypot(*exact.deflections[i]->sigma_m, 0.002), 1e-12);
  }
}

// Markers on the other side of the cloth: positive is where they face, as for their own distances.
TEST(Deflections, ArePositiveOnTheSideOfTheMarkers) {
  MarkerShape boat = BoatShape(), turned = boat;
  for (ShapeMarker& marker : turned.markers) {
    std::swap(marker.x_in_shape_m[1], marker.x_in_shape_m[2]);
    std::swap(marker.x_in_shape_m[4], marker.x_in_shape_m[3]);
  }
  const Eigen::Vector3d motion(0, 0.02, 0);
  for (const MarkerShape& reference : {boat, turned}) {
    const MarkerShape shape = Shifted(IdsOf("sail"), motion, reference);
    const double of_markers_m = CompareWithShape({shape, {}}, {reference, {}}, BoatLayout(),
                                                 WithMethod(AlignmentMethod::kNone), "sail")
                                    .distance_m.mean;
    double of_field_m = 0.0;
    for (const auto& deflection : FieldOf(shape, reference).deflections) {
      of_field_m += deflection->distance_m / (kNumPoints * kNumPoints);
    }
    EXPECT_NEAR(of_field_m, of_markers_m, 1e-3);
  }
}

TEST(Deflections, FromADesignAreAlongItsNormal) {
  const MeshDistance design(SailMesh());
  const MarkerShape shape = Shifted(IdsOf("sail"), {0, 0.02, 0}, BoatShape());
  const DeflectionReport report = ReportFrom(design, shape);
  const DeflectionField& field = report.fields.at(0);
  for (std::size_t i = 0; i < field.deflections.size(); ++i) {
    ASSERT_TRUE(field.deflections[i].has_value());
    const Eigen::Vector3d& x = field.reference.vertices_m[i];
    EXPECT_LT(std::abs(design.Project(x).distance_m), 1e-6);  // on the design
    EXPECT_LT(field.deflections[i]->vector_m.cross(field.reference.normals[i]).norm(), 1e-9);
    EXPECT_NEAR(field.deflections[i]->distance_m, 0.02 * field.reference.normals[i].y(), 3e-3);
  }
  EXPECT_THAT(report.notes, IsEmpty());
}

TEST(Deflections, AreUnknownBesideTheDesign) {
  const MeshDistance narrow(SailMesh(-0.1));
  const DeflectionField field = ReportFrom(narrow, BoatShape()).fields.at(0);
  EXPECT_FALSE(field.deflections.front().has_value());
  EXPECT_TRUE(field.deflections[kNumPoints * (kNumPoints / 2) + kNumPoints / 2].has_value());
  std::ostringstream vts;
  WriteDeflectionVts(field, "sail", vts);
  EXPECT_THAT(vts.str(), Not(HasSubstr("nan")));
  EXPECT_THAT(vts.str(), HasSubstr("Name=\"is_known\" format=\"ascii\">\n0\n"));
}

TEST(Deflections, APartWithoutASurfaceIsNoted) {
  MarkerShape shape = BoatShape();
  shape.markers.erase(shape.markers.begin() + 6, shape.markers.begin() + 30);  // h1 is left
  const DeflectionReport report = ReportOf(shape, BoatShape());
  EXPECT_THAT(report.fields, IsEmpty());
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("sail: no deflections: ")));
}

TEST(Deflections, FilesHoldPointAndVector) {
  const MarkerShape boat = BoatShape(0.001);
  const DeflectionReport report = ReportOf(Shifted(IdsOf("sail"), {0, 0.5, 0}, boat), boat);
  std::ostringstream csv, vts;
  WriteDeflectionCsv({{"trim2", &report}}, csv);
  std::istringstream in(csv.str());
  const std::vector<CsvRecord> records = ReadCsv(in, "deflection.csv");
  ASSERT_EQ(records.size(), 1u + kNumPoints * kNumPoints);
  EXPECT_THAT(records[0].fields, ElementsAre("shape", "part", "section", "point", "u", "v", "x",
                                             "y", "z", "dx", "dy", "dz", "distance", "sigma"));
  const std::vector<std::string>& last = records.back().fields;
  EXPECT_EQ(last[0], "trim2");
  EXPECT_EQ(last[1], "sail");
  EXPECT_EQ(last[2], std::to_string(kNumPoints));
  EXPECT_EQ(last[3], std::to_string(kNumPoints));
  EXPECT_NEAR(std::stod(last[10]), 0.5, 1e-9);
  WriteDeflectionVts(report.fields[0], "sail", vts);
  EXPECT_THAT(vts.str(),
              HasSubstr("Name=\"deflection\" NumberOfComponents=\"3\" format=\"ascii\">"));
  EXPECT_THAT(vts.str(), HasSubstr("Name=\"distance\""));
  EXPECT_THAT(vts.str(), HasSubstr("Name=\"sigma\""));
}

}  // namespace
}  // namespace velamap
