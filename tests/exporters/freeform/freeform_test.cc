// Surfaces without lines against exact truth, for markers drawn at random.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/freeform/freeform_shape.h"
#include "exporters/freeform/marker_front.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"
#include "tests/exporters/formats/ply_reader.h"
#include "tests/exporters/freeform/random_markers.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kNumDraws = 5;

// How the mesh lies to the truth: each vertex's distance over its stated sigma.
struct Agreement {
  double rms = 0.0, largest = 0.0;
};

Agreement AgreementOf(const FreeformSurface& surface, const TrueSurface& truth) {
  Agreement agreement;
  const auto& x = surface.mesh.vertices_m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double normalized = truth.distance_m(x[i]) / surface.mesh.sigmas_m[i];
    agreement.rms += normalized * normalized / static_cast<double>(x.size());
    agreement.largest = std::max(agreement.largest, std::abs(normalized));
  }
  agreement.rms = std::sqrt(agreement.rms);
  return agreement;
}

// Draws several sets of markers, and holds each surface to its sigmas.
void ExpectTruth(const TrueSurface& truth, const RandomMarkers& random,
                 const std::function<void(const FreeformSurface&)>& check) {
  std::mt19937 generator(18);
  double mean_square = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const auto markers = DrawMarkers(truth, random, &generator);
    const FreeformSurface surface = FitFreeformSurface(markers, random.side_m, std::nullopt);
    EXPECT_EQ(surface.residuals.size(), kNumCorners * markers.size());
    const Agreement agreement = AgreementOf(surface, truth);
    EXPECT_LT(agreement.largest, 5.0) << draw;
    mean_square += agreement.rms * agreement.rms / kNumDraws;
    for (const auto& [a, b, c] : surface.mesh.triangles) {
      const auto& x = surface.mesh.vertices_m;
      const Eigen::Vector3d middle = (x[a] + x[b] + x[c]) / 3;
      ASSERT_GT((x[b] - x[a]).cross(x[c] - x[a]).normalized().dot(TrueNormal(truth, middle)), 0.8);
    }
    check(surface);
  }
  // Errors are alike over wide areas, so that few draws hold few independent ones.
  EXPECT_LT(std::sqrt(mean_square), 1.5);
  EXPECT_GT(std::sqrt(mean_square), 0.2);
}

TEST(Freeform, SphereClosesWithItsVolume) {
  const double radius_m = 0.5;
  ExpectTruth(Sphere(radius_m), {0.2, 0.05, 2e-4}, [&](const FreeformSurface& surface) {
    EXPECT_NEAR(surface.area_m2, 4 * kPi * radius_m * radius_m, 1.5e-3);
    ASSERT_TRUE(surface.volume_m3);
    EXPECT_NEAR(*surface.volume_m3, 4 * kPi / 3 * std::pow(radius_m, 3), 1e-3);
    EXPECT_LT(surface.rms_sigma_m, 1e-4);  // half of the markers' own
  });
}

TEST(Freeform, CylinderStaysOpenAtItsEnds) {
  ExpectTruth(Cylinder(0.3, 1.2), {0.2, 0.05, 2e-4}, [](const FreeformSurface& surface) {
    EXPECT_FALSE(surface.volume_m3);
    EXPECT_GT(CountOpenEdges(surface.mesh.triangles), 0);
    EXPECT_NEAR(surface.area_m2, 2 * kPi * 0.3 * 1.2, 0.2);
  });
}

TEST(Freeform, SaddleLiesWithinItsSigmas) {
  ExpectTruth(Saddle(0.4, 0.7), {0.15, 0.05, 3e-4}, [](const FreeformSurface& surface) {
    EXPECT_FALSE(surface.volume_m3);
    EXPECT_LT(surface.rms_sigma_m, 1e-4);
  });
}

// No quadric: what it does between the markers is uncertain, and the sigma says so.
TEST(Freeform, TorusAndWaveLieWithinTheirSigmas) {
  ExpectTruth(Torus(0.6, 0.2), {0.15, 0.05, 2e-4}, [](const FreeformSurface& surface) {
    ASSERT_TRUE(surface.volume_m3);
    EXPECT_NEAR(*surface.volume_m3, 2 * kPi * kPi * 0.6 * 0.2 * 0.2, 2e-3);
  });
  ExpectTruth(Wave(0.06, 0.6), {0.12, 0.04, 2e-4}, [](const FreeformSurface& surface) {
    EXPECT_FALSE(surface.volume_m3);
    EXPECT_GT(surface.rms_sigma_m, 2e-4);
  });
}

TEST(Freeform, DoesNotDependOnTheFrame) {
  std::mt19937 generator(4);
  auto markers = DrawMarkers(Sphere(0.5), {0.25, 0.05, 2e-4}, &generator);
  const FreeformSurface surface = FitFreeformSurface(markers, 0.05, std::nullopt);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.2, 0.7, -0.3, 0.5).normalized().matrix();
  for (FreeformMarker& marker : markers) {
    marker.normal = turn * marker.normal;
    for (Eigen::Vector3d& x : marker.corners_in_shape_m) x = turn * x + Eigen::Vector3d(3, -7, 2);
  }
  const FreeformSurface turned = FitFreeformSurface(markers, 0.05, std::nullopt);
  EXPECT_NEAR(turned.area_m2, surface.area_m2, 1e-6);
  EXPECT_NEAR(turned.volume_m3.value(), surface.volume_m3.value(), 1e-6);
  EXPECT_NEAR(turned.rms_sigma_m, surface.rms_sigma_m, 1e-7);
}

TEST(Freeform, UnknownSigmasAreFoundFromTheScatter) {
  std::mt19937 generator(5);
  auto markers = DrawMarkers(Saddle(0.4, 0.7), {0.12, 0.05, 5e-4}, &generator);
  for (FreeformMarker& marker : markers) marker.sigmas_m = {};
  const FreeformSurface surface = FitFreeformSurface(markers, 0.05, std::nullopt);
  EXPECT_NEAR(surface.residuals[0].sigma_m, 5e-4, 1e-4);
}

TEST(Freeform, ResolutionIsAsAskedFor) {
  std::mt19937 generator(6);
  const auto markers = DrawMarkers(Sphere(0.5), {0.25, 0.05, 1e-4}, &generator);
  for (const double edge_mm : {40.0, 15.0}) {
    MeshOptions options;
    options.edge_length_mm = edge_mm;
    const TriangleMesh mesh = FitFreeformSurface(markers, 0.05, options).mesh;
    for (const auto& [a, b, c] : mesh.triangles) {
      ASSERT_LE((mesh.vertices_m[b] - mesh.vertices_m[a]).norm(), 1e-3 * edge_mm);
    }
  }
  MeshOptions options;
  options.chord_deviation_mm = 0.5;
  double largest_mm = 0;
  const FreeformSurface surface = FitFreeformSurface(markers, 0.05, options);
  for (const auto& [a, b, c] : surface.mesh.triangles) {
    const auto& x = surface.mesh.vertices_m;
    largest_mm = std::max(largest_mm, 1e3 * std::abs(((x[a] + x[b] + x[c]) / 3).norm() - 0.5));
  }
  EXPECT_LT(largest_mm, 0.5 + 0.3);  // and the error of the surface
  options = {};
  options.edge_length_mm = 1e-2;
  ExpectThrows<InputError>([&] { FitFreeformSurface(markers, 0.05, options); },
                           {"--Surface.edge_length", "triangles"});
  options = {};
  options.chord_deviation_mm = 1e-6;  // refused before triangles are divided for minutes
  ExpectThrows<InputError>([&] { FitFreeformSurface(markers, 0.05, options); },
                           {"--Surface.chord_deviation", "triangles"});
}

// A square of markers on a plane, as on a face of the cube. Many corners are on one circle.
std::vector<FreeformMarker> Grid(int size, const Eigen::Isometry3d& pose, int first_id) {
  std::vector<FreeformMarker> markers;
  for (int i = 0; i < size * size; ++i) {
    const Eigen::Vector3d center(i % size, i / size, 0.0);
    FreeformMarker marker;
    marker.marker_id = first_id + i;
    constexpr double kCorners[][2] = {{-0.25, 0.25}, {0.25, 0.25}, {0.25, -0.25}, {-0.25, -0.25}};
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      marker.corners_in_shape_m[k] =
          pose * (center + Eigen::Vector3d(kCorners[k][0], kCorners[k][1], 0));
      marker.sigmas_m[k] = 1e-3;
    }
    marker.normal = pose.linear() * Eigen::Vector3d::UnitZ();
    markers.push_back(marker);
  }
  return markers;
}

TEST(Freeform, GridIsAWholeSquareWithoutAMarkerToo) {
  auto markers = Grid(5, Eigen::Isometry3d::Identity(), 0);
  EXPECT_NEAR(FitFreeformSurface(markers, 0.5, std::nullopt).area_m2, 4.5 * 4.5, 1e-6);
  markers.erase(markers.begin() + 12);
  const FreeformSurface surface = FitFreeformSurface(markers, 0.5, std::nullopt);
  EXPECT_NEAR(surface.area_m2, 4.5 * 4.5, 1e-6);
  EXPECT_LT(surface.distance_m.rms, 1e-6);
  EXPECT_THAT(surface.notes, IsEmpty());
}

TEST(Freeform, MarkersThatStandApartAreNamed) {
  auto markers = Grid(4, Eigen::Isometry3d::Identity(), 0);
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation() = Eigen::Vector3d(0, 0, 9);
  for (const FreeformMarker& marker : Grid(1, far, 77)) markers.push_back(marker);
  const FreeformSurface surface = FitFreeformSurface(markers, 0.5, std::nullopt);
  EXPECT_THAT(surface.notes, ElementsAre(HasSubstr("left out: 77")));
  EXPECT_NEAR(surface.area_m2, 3.5 * 3.5, 1e-6);
  for (const int height : {20, 40}) {
    far.translation().z() = height;
    for (const FreeformMarker& marker : Grid(4, far, 100 * height)) markers.push_back(marker);
  }
  ExpectThrows<DataError>([&] { FitFreeformSurface(markers, 0.5, std::nullopt); },
                          {"16 of 49 markers are connected", "part of its own"});
  ExpectThrows<DataError>(
      [] { FitFreeformSurface(Grid(1, Eigen::Isometry3d::Identity(), 0), 0.5, std::nullopt); },
      {"1 whole markers; 4 to 1000 needed"});
}

MarkerShape ShapeOf(const std::vector<FreeformMarker>& markers, const std::string& part) {
  MarkerShape shape;
  for (const FreeformMarker& marker : markers) {
    ShapeMarker whole;
    whole.marker_id = marker.marker_id;
    whole.part = part;
    whole.x_in_shape_m[0] = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      whole.x_in_shape_m[i + 1] = marker.corners_in_shape_m[i];
      *whole.x_in_shape_m[0] += marker.corners_in_shape_m[i] / kNumCorners;
      whole.sigma_m[i + 1] = Eigen::Vector3d::Constant(*marker.sigmas_m[i]);
    }
    shape.markers.push_back(whole);
  }
  return shape;
}

std::string TextOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(FreeformShape, EachPartWithoutHorizontalLinesHasItsFiles) {
  Layout layout;
  layout.marker_length_m = 0.5;
  MarkerShape shape;
  for (const auto& [name, first_id] :
       {std::pair("top", 0), std::pair("few", 50), std::pair("columns", 200)}) {
    LayoutPart part;
    part.name = name;
    const auto markers = Grid(first_id == 50 ? 1 : 3, Eigen::Isometry3d::Identity(), first_id);
    for (int i = 0; i < 9; ++i) {
      if (first_id == 200 && i % 3 == 0) part.vertical.push_back({"v" + std::to_string(i), {}});
      (first_id == 200 ? part.vertical.back().marker_ids : part.marker_ids).push_back(first_id + i);
    }
    layout.parts.push_back(part);
    for (const ShapeMarker& marker : ShapeOf(markers, name).markers)
      shape.markers.push_back(marker);
  }
  LayoutPart with_line;
  with_line.name = "sail";
  with_line.horizontal.push_back({"h1", {100, 101, 102, 103, 104}});
  layout.parts.push_back(with_line);
  layout.parts[0].marker_ids.push_back(9);  // printed, but not in the shape
  const FreeformShape freeform = ComputeFreeform(shape, layout, nullptr, std::nullopt);
  ASSERT_EQ(freeform.surfaces.size(), 2u);
  EXPECT_EQ(freeform.surfaces[1].part, "columns");  // vertical lines alone bear no sail
  EXPECT_NEAR(freeform.surfaces[1].surface.area_m2, freeform.surfaces[0].surface.area_m2, 1e-9);
  EXPECT_NEAR(freeform.surfaces[0].surface.residuals[0].sigma_m, 1e-3, 1e-9);
  EXPECT_THAT(freeform.notes,
              ElementsAre("top: 1 of 10 markers is not whole; the surface ends at the others",
                          HasSubstr("few: no surface: 1 whole markers")));
  const TempDir dir;
  WriteFreeformFiles(freeform, {}, LengthUnit::kMetre, PlyFormat::kBinaryLittleEndian, dir.path());
  const PlyFile ply = ReadPly(TextOf(dir / "freeform.ply"));
  const TriangleMesh& mesh = freeform.surfaces[0].surface.mesh;
  EXPECT_EQ(ply.elements[0].Column("x").back(), mesh.vertices_m.back().x());
  EXPECT_EQ(ply.elements[0].Column("sigma").back(), static_cast<float>(mesh.sigmas_m.back()));
  EXPECT_EQ(ply.elements[1].rows.size(), mesh.triangles.size());
  EXPECT_TRUE(std::filesystem::exists(dir / "freeform.obj"));
  EXPECT_TRUE(std::filesystem::exists(dir / "freeform.stl"));
  std::istringstream residuals(TextOf(dir / "freeform_residuals.csv"));
  const auto rows = ReadCsv(residuals, "residuals");
  ASSERT_EQ(rows.size(), 1u + 2 * 9 * kNumCorners);
  EXPECT_THAT(rows[5].fields[0], "top");
}

TEST(FreeformShape, ALayoutWithoutPartsIsOneSurface) {
  std::mt19937 generator(8);
  const MarkerShape shape = ShapeOf(DrawMarkers(Sphere(0.5), {0.25, 0.05, 1e-4}, &generator), "");
  Layout layout;
  layout.marker_length_m = 0.05;
  const FreeformShape freeform = ComputeFreeform(shape, layout, nullptr, std::nullopt);
  ASSERT_EQ(freeform.surfaces.size(), 1u);
  EXPECT_TRUE(freeform.surfaces[0].surface.volume_m3);
  MeshOptions absurd;
  absurd.edge_length_mm = 1e-3;
  const FreeformShape refused = ComputeFreeform(shape, layout, nullptr, absurd);
  EXPECT_THAT(refused.surfaces, IsEmpty());
  ASSERT_TRUE(refused.surface_error);
  EXPECT_THROW(std::rethrow_exception(refused.surface_error), InputError);
}

TEST(Freeform, SizesAreInUnitsThatSuitThem) {
  FreeformSurface surface;
  surface.area_m2 = 0.31389;
  EXPECT_EQ(SizeText(surface), "0.3139 m2");
  surface.volume_m3 = 0.02141;
  EXPECT_EQ(SizeText(surface), "0.3139 m2, closed, 0.02141 m3");
  surface.area_m2 = 0.0384;
  surface.volume_m3 = 512e-6;
  EXPECT_EQ(SizeText(surface), "38400 mm2, closed, 512000 mm3");
}

}  // namespace
}  // namespace velamap
