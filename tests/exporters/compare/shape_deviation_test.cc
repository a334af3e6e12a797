#include "exporters/compare/shape_deviation.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/compare/comparison_sigma.h"
#include "importer/base/error.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/example_covariance.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AlignmentOptions By(AlignmentMethod method, const std::vector<int>& ids = {}) {
  AlignmentOptions options;
  options.method = method;
  options.marker_ids = ids;
  return options;
}

const MarkerDeviation& Find(const ShapeDeviation& deviation, int marker_id) {
  const auto it = std::find_if(deviation.markers.begin(), deviation.markers.end(),
                               [&](const auto& m) { return m.marker_id == marker_id; });
  if (it == deviation.markers.end()) throw std::runtime_error("no such marker");
  return *it;
}

TEST(ShapeDeviation, AShapeMovedRigidlyDoesNotDiffer) {
  const MarkerShape moved = Moved(FarPose(), BoatShape());
  for (const AlignmentOptions& options :
       {By(AlignmentMethod::kAuto), By(AlignmentMethod::kReferencePart),
        By(AlignmentMethod::kBestFit), By(AlignmentMethod::kMarkers, {11, 16, 51})}) {
    const ShapeDeviation deviation =
        CompareWithShape(Exact(moved), Exact(BoatShape()), BoatLayout(), options);
    EXPECT_EQ(deviation.markers.size(), 36u);
    EXPECT_EQ(deviation.distance_m.count, 36);
    EXPECT_LT(deviation.difference_m.max, 1e-12);
    EXPECT_LT(deviation.alignment.residual_m.max, 1e-12);
    EXPECT_NEAR(deviation.scale.value(), 1.0, 1e-12);
    EXPECT_EQ(deviation.num_with_sigma, 0);
  }
  const ShapeDeviation as_is =
      CompareWithShape(Exact(moved), Exact(BoatShape()), BoatLayout(), By(AlignmentMethod::kNone));
  EXPECT_GT(as_is.difference_m.min, 1.0);
}

TEST(ShapeDeviation, AMovedPartShowsByExactlyItsMotion) {
  const Eigen::Vector3d shift_m(0.01, 0.03, -0.02);
  const MarkerShape boat = BoatShape(), trimmed = Shifted(IdsOf("sail"), shift_m, boat);
  const ShapeDeviation deviation =
      CompareWithShape(Exact(Moved(FarPose(), trimmed)), Exact(boat), BoatLayout(), {});
  EXPECT_EQ(deviation.alignment.method, AlignmentMethod::kReferencePart);
  EXPECT_THAT(deviation.alignment.description, HasSubstr("part hull, 24 corners of 6 markers"));
  for (const MarkerDeviation& marker : deviation.markers) {
    const Eigen::Vector3d truth_m =
        marker.part == "sail" ? shift_m : Eigen::Vector3d(Eigen::Vector3d::Zero());
    EXPECT_LT((*marker.difference_m - truth_m).norm(), 1e-12) << marker.marker_id;
    const ShapeMarker& reference = *FindWholeMarker(boat, marker.marker_id);
    EXPECT_NEAR(marker.distance_m, MarkerNormal(reference).dot(truth_m), 1e-12);
    EXPECT_TRUE(marker.normal.isApprox(MarkerNormal(reference), 1e-12));
  }
  EXPECT_THAT(deviation.aligned_shape.markers, ::testing::SizeIs(36));
}

// Distances along the outward normal of the marker are positive.
TEST(ShapeDeviation, SignIsThatOfTheReferencesNormal) {
  const MarkerShape reference = BoatShape();
  const Eigen::Vector3d normal = MarkerNormal(*FindWholeMarker(reference, 33));
  for (const double distance_m : {0.02, -0.005}) {
    const ShapeDeviation deviation = CompareWithShape(
        Exact(Shifted({33}, distance_m * normal, reference)), Exact(reference), BoatLayout(), {});
    EXPECT_NEAR(Find(deviation, 33).distance_m, distance_m, 1e-12);
    EXPECT_NEAR(Find(deviation, 32).distance_m, 0, 1e-12);
  }
}

TEST(ShapeDeviation, SwappingTheTwoTurnsTheSignOfTheVector) {
  const MarkerShape other = Shifted(IdsOf("sail"), {0.01, 0.03, -0.02}, BoatShape());
  const ShapeDeviation there = CompareWithShape(Exact(other), Exact(BoatShape()), BoatLayout(), {});
  const ShapeDeviation back = CompareWithShape(Exact(BoatShape()), Exact(other), BoatLayout(), {});
  for (const MarkerDeviation& marker : there.markers) {
    EXPECT_LT((*marker.difference_m + *Find(back, marker.marker_id).difference_m).norm(), 1e-12);
  }
  EXPECT_NEAR(*there.scale * *back.scale, 1.0, 1e-9);
}

TEST(ShapeDeviation, ScaleIsReportedAndNeverFitted) {
  MarkerShape larger = BoatShape();
  for (ShapeMarker& marker : larger.markers) {
    for (auto& x : marker.x_in_shape_m) *x *= 1.01;
  }
  const ShapeDeviation deviation = CompareWithShape(Exact(larger), Exact(BoatShape()), BoatLayout(),
                                                    By(AlignmentMethod::kBestFit));
  EXPECT_NEAR(*deviation.scale, 1.01, 1e-9);
  EXPECT_GT(deviation.difference_m.max, 0.02);
}

TEST(ShapeDeviation, WithoutEnoughOfTheReferencePartItIsABestFitAndSaysSo) {
  const MarkerShape few = Without({120, 121, 122, 123}, BoatShape());
  const ShapeDeviation deviation =
      CompareWithShape(Exact(few), Exact(BoatShape()), BoatLayout(), {});
  EXPECT_EQ(deviation.alignment.method, AlignmentMethod::kBestFit);
  EXPECT_THAT(deviation.alignment.notes, ElementsAre(HasSubstr("2 markers whole in both")));
  EXPECT_THAT(deviation.only_in_reference, ElementsAre(120, 121, 122, 123));
  const ShapeDeviation asked = CompareWithShape(Exact(few), Exact(BoatShape()), BoatLayout(),
                                                By(AlignmentMethod::kReferencePart));
  EXPECT_EQ(asked.alignment.method, AlignmentMethod::kReferencePart);
  const ShapeDeviation without_layout = CompareWithShape(Exact(few), Exact(BoatShape()), {}, {});
  EXPECT_THAT(without_layout.alignment.notes, ElementsAre(HasSubstr("names no reference part")));
}

TEST(ShapeDeviation, LinesAndPartsHaveTheirOwnFigures) {
  MarkerShape trimmed = BoatShape();
  for (const int id : {31, 32, 33, 34, 35, 36}) {
    const Eigen::Vector3d normal = MarkerNormal(*FindWholeMarker(trimmed, id));
    trimmed = Shifted({id}, 0.01 * normal, trimmed);
  }
  const ShapeDeviation deviation =
      CompareWithShape(Exact(trimmed), Exact(BoatShape()), BoatLayout(), {});
  ASSERT_EQ(deviation.parts.size(), 2u);
  EXPECT_EQ(deviation.parts[1].part, "sail");
  EXPECT_NEAR(deviation.parts[1].distance_m.mean, 0.01 * 6 / 30, 1e-12);
  ASSERT_EQ(deviation.lines.size(), 5u);
  EXPECT_EQ(deviation.lines[2].line, "h3");
  EXPECT_NEAR(deviation.lines[2].distance_m.min, 0.01, 1e-12);
  EXPECT_NEAR(deviation.lines[1].distance_m.rms, 0.0, 1e-12);
  const ShapeDeviation hull =
      CompareWithShape(Exact(trimmed), Exact(BoatShape()), BoatLayout(), {}, "hull");
  EXPECT_EQ(hull.markers.size(), 6u);
  ExpectThrows<InputError>(
      [&] { CompareWithShape(Exact(trimmed), Exact(BoatShape()), BoatLayout(), {}, "jib"); },
      {"--part", "jib", "hull, sail"});
}

// Sigmas of the difference match its scatter, including that of the alignment: a marker of the sail
// is far from the hull that defines the frame.
TEST(ShapeDeviation, SigmasAreWhatRepetitionsScatterBy) {
  const MarkerShape reference = BoatShape(0.002), shape = Moved(FarPose(), BoatShape(0.001));
  for (const AlignmentMethod method :
       {AlignmentMethod::kReferencePart, AlignmentMethod::kBestFit, AlignmentMethod::kNone}) {
    const UncertainShape uncertain_reference = WithSigmas(reference);
    const UncertainShape uncertain_shape = WithSigmas(shape);
    const ShapeDeviation deviation =
        CompareWithShape(uncertain_shape, uncertain_reference, BoatLayout(), By(method));
    for (const int id : {53, 121}) {
      const MarkerDeviation& marker = Find(deviation, id);
      const double by_shape =
          SampledSigma(shape, uncertain_shape.covariance, [&](const MarkerShape& sample) {
            const Alignment alignment = AlignShapes(sample, reference, BoatLayout(), By(method));
            return marker.normal.dot(alignment.reference_from_shape *
                                     *FindWholeMarker(sample, id)->x_in_shape_m[0]);
          });
      const double by_reference =
          SampledSigma(reference, uncertain_reference.covariance, [&](const MarkerShape& sample) {
            const Alignment alignment = AlignShapes(shape, sample, BoatLayout(), By(method));
            const Eigen::Vector3d aligned =
                alignment.reference_from_shape * *FindWholeMarker(shape, id)->x_in_shape_m[0];
            return marker.normal.dot(aligned - *FindWholeMarker(sample, id)->x_in_shape_m[0]);
          });
      const double sampled = std::hypot(by_shape, by_reference);
      EXPECT_NEAR(*marker.sigma_m / sampled, 1.0, 0.05) << id << " " << static_cast<int>(method);
    }
    EXPECT_EQ(deviation.num_with_sigma, 36);
    // The sigma of the vector is at least that along the normal.
    const MarkerDeviation& any = deviation.markers.front();
    EXPECT_GE(any.difference_sigma_m->norm(), *any.sigma_m);
  }
}

TEST(ShapeDeviation, SignificanceIsDistanceOverSigma) {
  const MarkerShape reference = BoatShape(0.001);
  const Eigen::Vector3d normal = MarkerNormal(*FindWholeMarker(reference, 33));
  const ShapeDeviation deviation =
      CompareWithShape(WithSigmas(Shifted({33}, -0.05 * normal, reference)), WithSigmas(reference),
                       BoatLayout(), {});
  const MarkerDeviation& marker = Find(deviation, 33);
  EXPECT_NEAR(*marker.significance, marker.distance_m / *marker.sigma_m, 1e-12);
  EXPECT_LT(*marker.significance, -2);
  EXPECT_EQ(deviation.num_significant, 1);
  EXPECT_EQ(deviation.lines[2].num_significant, 1);
}

TEST(ShapeDeviation, AShapeWithoutSigmasGivesNone) {
  const MarkerShape shape = BoatShape();
  const ShapeDeviation one_sided =
      CompareWithShape(WithSigmas(shape), WithSigmas(BoatShape(0.001)), BoatLayout(), {});
  EXPECT_EQ(one_sided.num_with_sigma, 0);
  // If one marker of the alignment has no sigma, no marker has one.
  MarkerShape partly = BoatShape(0.001);
  partly.markers.back().sigma_m = {};
  const ShapeDeviation deviation =
      CompareWithShape(WithSigmas(partly), WithSigmas(BoatShape(0.001)), BoatLayout(), {});
  EXPECT_EQ(deviation.num_with_sigma, 0);
}

TEST(ShapeDeviation, CovarianceFromSigmasHasTheSigmasOfTheFile) {
  MarkerShape shape = BoatShape(0.002);
  for (ShapeMarker& marker : shape.markers) {
    marker.sigma_m[0] = Eigen::Vector3d(0.0011, 0.002, 0.0015);  // corners err together in part
  }
  const Eigen::MatrixXd dense = DenseCovariance(CovarianceFromSigmas(shape));
  EXPECT_NEAR(std::sqrt(dense(0, 0)), 0.002, 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    double center = 0.0;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) center += dense(3 * i + axis, 3 * j + axis) / 16;
    }
    EXPECT_NEAR(std::sqrt(center), (*shape.markers[0].sigma_m[0])[axis], 1e-12);
  }
  EXPECT_TRUE(dense.isApprox(dense.transpose()));
}

TEST(ShapeDeviation, ShapesThatHaveNothingInCommon) {
  const auto compare = [](const MarkerShape& a, const MarkerShape& b, const AlignmentOptions& by) {
    CompareWithShape(Exact(a), Exact(b), BoatLayout(), by);
  };
  const MarkerShape sail = Without(IdsOf("hull"), BoatShape());
  const MarkerShape hull = Without(IdsOf("sail"), BoatShape());
  ExpectThrows<DataError>([&] { compare(sail, hull, {}); }, {"0 marker corners in common"});
  ExpectThrows<DataError>([&] { compare(sail, hull, By(AlignmentMethod::kNone)); },
                          {"no whole marker in common"});
  ExpectThrows<InputError>(
      [&] { compare(sail, BoatShape(), By(AlignmentMethod::kMarkers, {120})); },
      {"--align_markers", "120", "the shape has no marker 120"});
  ExpectThrows<InputError>([&] { compare(sail, sail, By(AlignmentMethod::kMarkers)); },
                           {"--align_markers", "missing"});
  ExpectThrows<InputError>(
      [&] { CompareWithShape(Exact(sail), Exact(sail), {}, By(AlignmentMethod::kReferencePart)); },
      {"--align reference_part", "names no reference_part"});
  MarkerShape thin;  // corners on one line
  ShapeMarker marker = BoatShape().markers.front();
  for (std::size_t i = 1; i <= kNumCorners; ++i) {
    marker.x_in_shape_m[i] = Eigen::Vector3d(0.1 * static_cast<double>(i), 0, 0);
  }
  thin.markers = {marker};
  ExpectThrows<DataError>([&] { compare(thin, thin, {}); }, {"on one line"});
}

TEST(ShapeDeviation, NamesOfTheMethods) {
  for (const char* name : {"auto", "reference_part", "markers", "best_fit", "none"}) {
    EXPECT_EQ(AlignmentMethodName(AlignmentMethodFromName(name, "--align")), name);
  }
  ExpectThrows<InputError>([] { AlignmentMethodFromName("hull", "--align"); },
                           {"--align", "hull", "reference_part"});
}

TEST(ShapeDeviation, ListOfMarkers) {
  EXPECT_THAT(MarkerIdsFromText("120,7,0", "--align_markers"), ElementsAre(120, 7, 0));
  EXPECT_THAT(MarkerIdsFromText("120-122,7", "--align_markers"), ElementsAre(120, 121, 122, 7));
  for (const char* text : {"", "1,", "1;2", "1, 2", "a", "-1", "8192", "1,,2"}) {
    ExpectThrows<InputError>([&] { MarkerIdsFromText(text, "--align_markers"); },
                             {"--align_markers", "120,121"});
  }
}

}  // namespace
}  // namespace velamap
