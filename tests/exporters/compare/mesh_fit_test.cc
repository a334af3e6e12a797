#include "exporters/compare/mesh_fit.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/shape_deviation.h"
#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

AlignmentOptions FitBy(AlignmentMethod method, bool starts_as_is = false) {
  AlignmentOptions options;
  options.method = method;
  options.starts_as_is = starts_as_is;
  return options;
}

MarkerShape Sail(double sigma_m = 0.0) {
  return MarkersOnPart(BentBoatShape(sigma_m), BoatLayout(), "sail");
}

// A marker of 0.1 m facing outwards, with its corners at `radius_m` from the origin.
ShapeMarker MarkerOnSphere(int id, const Eigen::Vector3d& direction, double radius_m) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction);
  ShapeMarker marker = SquareMarker(id, 0.1, {rotation, radius_m * direction.normalized()});
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    marker.x_in_shape_m[corner] = radius_m * marker.x_in_shape_m[corner]->normalized();
  }
  marker.x_in_shape_m[0] = MeanOfCorners(marker);
  marker.part = "ball";
  return marker;
}

MarkerShape Ball(double radius_m) {
  MarkerShape shape;
  for (int i = 0; i < 20; ++i) {
    const double z = -0.9 + 1.8 * i / 19, around = 2.4 * i, r = std::sqrt(1 - z * z);
    shape.markers.push_back(
        MarkerOnSphere(i, {r * std::cos(around), r * std::sin(around), z}, radius_m));
  }
  return shape;
}

TEST(ShapeDeviationMesh, DistancesToASphereWithoutAlignment) {
  const MeshDistance mesh(SphereMesh(1.0, 150));
  for (const double offset_m : {0.03, -0.02}) {
    const ShapeDeviation deviation =
        CompareWithMesh(Exact(Ball(1.0 + offset_m)), mesh, {}, FitBy(AlignmentMethod::kNone));
    EXPECT_EQ(deviation.distance_m.count, 20);
    EXPECT_NEAR(deviation.distance_m.min, offset_m, 3e-4);
    EXPECT_NEAR(deviation.distance_m.max, offset_m, 3e-4);
    EXPECT_FALSE(deviation.scale.has_value());
    EXPECT_EQ(deviation.parts.front().part, "ball");
  }
}

TEST(ShapeDeviationMesh, FindsItsPlaceFromFarAway) {
  const MeshDistance mesh(SailMesh());
  const MarkerShape far = Moved(FarPose(), Sail());
  const ShapeDeviation deviation = CompareWithMesh(Exact(far), mesh, BoatLayout(), {});
  EXPECT_EQ(deviation.alignment.method, AlignmentMethod::kBestFit);
  EXPECT_LT(deviation.distance_m.rms, 1e-4);
  EXPECT_EQ(deviation.distance_m.count, 30);
  for (const MarkerDeviation& marker : deviation.markers) {
    EXPECT_LT(
        (marker.x_in_reference_m - *FindWholeMarker(Sail(), marker.marker_id)->x_in_shape_m[0])
            .norm(),
        0.02);
  }
  EXPECT_THAT(deviation.alignment.notes, IsEmpty());
}

TEST(ShapeDeviationMesh, AFewMarkersThatDifferDoNotPullTheRestAlong) {
  const MeshDistance mesh(SailMesh());
  const Eigen::Vector3d normal = MarkerNormal(*FindWholeMarker(Sail(), 33));
  const MarkerShape dented = Shifted({33}, -0.08 * normal, Sail());
  const ShapeDeviation deviation =
      CompareWithMesh(Exact(Moved(FarPose(), dented)), mesh, BoatLayout(), {});
  for (const MarkerDeviation& marker : deviation.markers) {
    EXPECT_NEAR(marker.distance_m, marker.marker_id == 33 ? -0.08 : 0.0, 3e-3) << marker.marker_id;
  }
}

TEST(ShapeDeviationMesh, AsIsStaysNearTheStart) {
  const MeshDistance mesh(SailMesh());
  const Rigid3 near{Eigen::Quaterniond(Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX())),
                    {0.02, 0.03, -0.02}};
  const ShapeDeviation deviation = CompareWithMesh(Exact(Moved(near, Sail())), mesh, BoatLayout(),
                                                   FitBy(AlignmentMethod::kBestFit, true));
  EXPECT_LT(deviation.distance_m.rms, 1e-3);
  EXPECT_LT(AngularDistance(deviation.alignment.reference_from_shape, Inverse(near)), 0.01);
}

// The surface covers the lower half of the sail only; markers on the other half have no distance.
TEST(ShapeDeviationMesh, MarkersBesideTheSurfaceAreNotMeasured) {
  TriangleMesh half = SailMesh();
  auto& t = half.triangles;
  t.erase(std::remove_if(t.begin(), t.end(),
                         [&](const auto& triangle) {
                           return half.vertices_m[static_cast<std::size_t>(triangle[0])].z() > 2.5;
                         }),
          t.end());
  const ShapeDeviation deviation = CompareWithMesh(Exact(Sail()), MeshDistance(half), BoatLayout(),
                                                   FitBy(AlignmentMethod::kNone));
  EXPECT_EQ(deviation.num_beside, 12);
  EXPECT_EQ(deviation.distance_m.count, 18);
  EXPECT_LT(deviation.distance_m.rms, 1e-3);
  EXPECT_EQ(deviation.lines[4].distance_m.count, 0);
  EXPECT_FALSE(deviation.markers.back().is_over_surface);
  EXPECT_GT(deviation.markers.back().beside_m, 1.0);
  ExpectThrows<DataError>(
      [&] {
        CompareWithMesh(Exact(Shifted(IdsOf("sail"), {20, 0, 0}, Sail())), MeshDistance(half),
                        BoatLayout(), FitBy(AlignmentMethod::kNone));
      },
      {"none of the 30 whole markers", "best_fit"});
}

// The design ends at the outer markers, as a surface through markers does, and noise takes half of
// those beyond its edge.
TEST(ShapeDeviationMesh, MarkersAtTheEdgeOfADesignCount) {
  const MeshDistance mesh(SailMesh(0.0));
  const MarkerShape sail = Sail(0.004);
  const PointCovariance covariance = CovarianceFromSigmas(sail);
  const EdgeOptions none{0.0, 0.0};
  int num_beside = 0, num_counted = 0, num_beyond = 0, num_far = 0;
  SampleShapes(sail, covariance, 20, [&](const MarkerShape& sample) {
    const auto compare = [&](const EdgeOptions& edge) {
      return CompareWithMesh({sample, covariance}, mesh, BoatLayout(),
                             FitBy(AlignmentMethod::kNone), "", edge);
    };
    num_beside += compare(none).num_beside;
    const ShapeDeviation deviation = compare({});
    num_counted += deviation.distance_m.count;
    num_beyond += deviation.num_beyond_edge;
    for (const MarkerDeviation& marker : deviation.markers) {
      // The distance is the marker's own noise, whether the foot is on the edge or not.
      const Eigen::Vector3d noise_m =
          marker.x_in_reference_m - *FindWholeMarker(sail, marker.marker_id)->x_in_shape_m[0];
      EXPECT_NEAR(marker.distance_m, marker.normal.dot(noise_m), 4e-4) << marker.marker_id;
      num_far += std::abs(*marker.significance) > 3 ? 1 : 0;
    }
    EXPECT_EQ(compare({0.0, 5.0}).num_beside, 0);
    EXPECT_GT(compare({0.0, 0.5}).num_beside, 0);
  });
  // 18 of the 30 markers stand on the edge.
  EXPECT_GT(num_beside, 20 * 6);
  EXPECT_EQ(num_counted, 20 * 30);
  EXPECT_EQ(num_beyond, num_beside);
  EXPECT_LE(num_far, 6);  // of 600, 0.27 %
}

TEST(ShapeDeviationMesh, MarkersFarBeyondTheEdgeAreBeside) {
  const MeshDistance mesh(SailMesh(-0.05));
  const MarkerShape sail = Sail();
  const auto num_beside = [&](double tolerance_mm) {
    return CompareWithMesh(Exact(sail), mesh, BoatLayout(), FitBy(AlignmentMethod::kNone), "",
                           {tolerance_mm, 3.0})
        .num_beside;
  };
  EXPECT_EQ(num_beside(20.0), 18);
  EXPECT_EQ(num_beside(100.0), 0);  // also those at the corners
  ExpectThrows<InputError>([&] { num_beside(-1.0); }, {"--edge_tolerance"});
}

TEST(ShapeDeviationMesh, SaysWhichMotionsTheSurfaceLeavesOpen) {
  const ShapeDeviation ball =
      CompareWithMesh(Exact(Ball(1.0)), MeshDistance(SphereMesh(1.0, 40)), {}, {});
  MarkerShape board;
  for (int i = 0; i < 9; ++i) {
    board.markers.push_back(SquareMarker(
        i, 0.1, {Eigen::Quaterniond::Identity(), {0.3 * (i % 3), 0.2 * (i / 3), 0.4}}));
  }
  const ShapeDeviation plane =
      CompareWithMesh(Exact(board), MeshDistance(PlaneMesh(2.0, 3)), {}, {});
  EXPECT_LT(plane.distance_m.rms, 1e-9);
  EXPECT_THAT(plane.alignment.notes,
              Contains(HasSubstr("does not determine 3 of 6 rigid motions")));
  EXPECT_THAT(plane.alignment.notes, Contains(HasSubstr("fits equally well")));
  EXPECT_LT(ball.distance_m.rms, 5e-3);
}

TEST(ShapeDeviationMesh, SigmasAreWhatRepetitionsScatterBy) {
  const MeshDistance mesh(SailMesh());
  const MarkerShape sail = Sail(0.002);
  const UncertainShape uncertain{sail, CovarianceFromSigmas(sail)};
  const AlignmentOptions options = FitBy(AlignmentMethod::kBestFit, true);
  const ShapeDeviation deviation = CompareWithMesh(uncertain, mesh, BoatLayout(), options);
  ASSERT_EQ(deviation.num_with_sigma, 30);
  std::vector<std::vector<double>> distances_m(30);
  SampleShapes(sail, uncertain.covariance, 100, [&](const MarkerShape& sample) {
    const ShapeDeviation sampled = CompareWithMesh(Exact(sample), mesh, BoatLayout(), options);
    for (std::size_t i = 0; i < 30; ++i) distances_m[i].push_back(sampled.markers[i].distance_m);
  });
  double predicted = 0.0, sampled = 0.0;
  for (std::size_t i = 0; i < 30; ++i) {
    predicted += std::pow(*deviation.markers[i].sigma_m, 2);
    sampled += std::pow(ComputeStatistics(distances_m[i]).standard_deviation, 2);
  }
  EXPECT_NEAR(std::sqrt(predicted / sampled), 1.0, 0.08);
}

// Feet go back and forth between triangles, whose normals differ.
TEST(ShapeDeviationMesh, FitsToTheFacetsOfAMeshConverge) {
  const MeshDistance mesh(SailMesh());
  const MarkerShape sail = Sail(0.002);
  SampleShapes(sail, CovarianceFromSigmas(sail), 20, [&](const MarkerShape& sample) {
    const Alignment alignment = AlignToMesh(sample, mesh, FitBy(AlignmentMethod::kBestFit, true));
    EXPECT_THAT(alignment.notes, IsEmpty());
  });
}

// The surface that velamap fits to the markers lies on the cloth, and so do the corners; the means
// of the corners lie up to 2 mm beside it.
TEST(ShapeDeviationMesh, AShapeIsAsFarFromItsOwnSurfaceAsTheResidualsSay) {
  const MarkerShape sail = Sail(0.0005);
  const PointCovariance covariance = CovarianceFromSigmas(sail);
  int num_significant = 0, num_markers = 0;
  SampleShapes(sail, covariance, 4, [&](const MarkerShape& sample) {
    const FittedSurface fit =
        FitSurface(CollectSurfaceInput(sample, *FirstPartWithLines(BoatLayout())));
    const MeshDistance mesh(MeshSurface(fit.surface, DefaultMeshOptions(fit.surface, 0.1)));
    const auto compare = [&](AlignmentMethod method) {
      return CompareWithMesh({sample, covariance}, mesh, BoatLayout(), FitBy(method), "", {},
                             fit.distance_m.rms);
    };
    const ShapeDeviation as_is = compare(AlignmentMethod::kNone);
    ASSERT_EQ(as_is.markers.size(), fit.residuals.size());
    for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
      EXPECT_NEAR(as_is.markers[i].distance_m, fit.residuals[i].distance_m, 2e-4)
          << fit.residuals[i].marker_id;
    }
    EXPECT_EQ(as_is.surface_sigma_m, fit.distance_m.rms);
    for (const AlignmentMethod method : {AlignmentMethod::kNone, AlignmentMethod::kBestFit}) {
      num_significant += compare(method).num_significant;
      num_markers += 30;
    }
  });
  EXPECT_LT(num_significant, 0.05 * num_markers);
}

TEST(ShapeDeviationMesh, TheSigmaOfTheSurfaceAddsToThatOfTheMarkers) {
  const MeshDistance mesh(SailMesh());
  const UncertainShape sail = WithSigmas(Sail(0.002));
  const auto compare = [&](double surface_sigma_m) {
    return CompareWithMesh(sail, mesh, BoatLayout(), FitBy(AlignmentMethod::kNone), "", {},
                           surface_sigma_m);
  };
  const ShapeDeviation exact = compare(0.0), uncertain = compare(0.003);
  for (std::size_t i = 0; i < exact.markers.size(); ++i) {
    EXPECT_NEAR(*uncertain.markers[i].sigma_m, std::hypot(*exact.markers[i].sigma_m, 0.003), 1e-12);
  }
}

TEST(ShapeDeviationMesh, UnitHintForAWrongUnit) {
  TriangleMesh mesh = SailMesh();
  EXPECT_FALSE(UnitHint(BoatShape(), MeshDistance(mesh)).has_value());
  for (Eigen::Vector3d& x : mesh.vertices_m) x *= 1e3;
  EXPECT_EQ(UnitHint(BoatShape(), MeshDistance(mesh)), 1e-3);
  for (Eigen::Vector3d& x : mesh.vertices_m) x *= 1e-6;
  EXPECT_EQ(UnitHint(BoatShape(), MeshDistance(mesh)), 1e3);
}

TEST(ShapeDeviationMesh, RefusesWhatASurfaceCannotDo) {
  const MeshDistance mesh(SailMesh());
  ExpectThrows<InputError>(
      [&] { AlignToMesh(BoatShape(), mesh, FitBy(AlignmentMethod::kReferencePart)); },
      {"--align reference_part", "best_fit"});
  MarkerShape one;
  one.markers = {BoatShape().markers.front()};
  ExpectThrows<DataError>([&] { AlignToMesh(one, mesh, {}); }, {"4 marker corners", "needs 6"});
}

}  // namespace
}  // namespace velamap
