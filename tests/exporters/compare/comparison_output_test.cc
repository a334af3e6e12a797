// Keys and PLY of a comparison.

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/compare/comparison.h"
#include "exporters/compare/comparison_report.h"
#include "exporters/compare/comparison_sigma.h"
#include "exporters/comparison_page/comparison_ply.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/formats/ply_reader.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Marker 33 is 20 mm in front of the surface, marker 44 is 10 mm behind it.
ShapeDeviation Example(double sigma_m = 0.0) {
  const MarkerShape reference = BoatShape(sigma_m);
  const auto normal = [&](int id) { return MarkerNormal(*FindWholeMarker(reference, id)); };
  const MarkerShape shape =
      Shifted({33}, 0.02 * normal(33), Shifted({44}, -0.01 * normal(44), reference));
  return CompareWithShape(WithSigmas(shape), WithSigmas(reference), BoatLayout(), {});
}

std::string Ply(const ShapeDeviation& deviation, std::optional<double> limit_m = std::nullopt) {
  std::ostringstream out;
  WriteComparisonPly(deviation, limit_m, out);
  return out.str();
}

TEST(ComparisonPly, HoldsDistanceColourAndPlace) {
  const ShapeDeviation deviation = Example(0.001);
  const std::string text = Ply(deviation);
  EXPECT_THAT(text, HasSubstr("alignment: reference_part"));
  EXPECT_THAT(text, HasSubstr("blue -20 mm, white 0, red +20 mm"));
  const PlyFile ply = ReadPly(text);
  const PlyReadElement& vertices = ply.elements[0];
  ASSERT_EQ(vertices.rows.size(), 4u * 36);
  ASSERT_EQ(ply.elements[1].rows.size(), 36u);
  for (std::size_t i = 0; i < vertices.rows.size(); ++i) {
    const MarkerDeviation& marker = deviation.markers[i / 4];
    EXPECT_EQ(vertices.Column("marker_id")[i], marker.marker_id);
    EXPECT_NEAR(vertices.Column("distance")[i], marker.distance_m, 1e-8);
    EXPECT_NEAR(vertices.Column("sigma")[i], *marker.sigma_m, 1e-8);
    const auto& x =
        *FindWholeMarker(deviation.aligned_shape, marker.marker_id)->x_in_shape_m[i % 4 + 1];
    EXPECT_EQ(vertices.Column("x")[i], x.x());
    const double red = vertices.Column("red")[i], blue = vertices.Column("blue")[i];
    if (marker.marker_id == 33) {
      EXPECT_EQ(red, 178);
      EXPECT_EQ(blue, 43);
    } else if (marker.marker_id == 44) {
      EXPECT_GT(blue, red);
      EXPECT_EQ(red, 140);  // halfway from white to blue
    } else {
      EXPECT_EQ(red, 247);
    }
  }
  // The face is counter-clockwise seen from the front of the marker.
  const std::vector<double> face = ply.elements[1].ListColumn("vertex_indices")[0];
  const auto corner = [&](std::size_t k) {
    const auto row = static_cast<std::size_t>(face[k]);
    return Eigen::Vector3d(vertices.Column("x")[row], vertices.Column("y")[row],
                           vertices.Column("z")[row]);
  };
  const Eigen::Vector3d normal(vertices.Column("nx")[0], vertices.Column("ny")[0],
                               vertices.Column("nz")[0]);
  EXPECT_GT((corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(normal), 0);
}

TEST(ComparisonPly, LimitClampsAndNoSigmaIsNoProperty) {
  const std::string text = Ply(Example(), 0.005);
  EXPECT_THAT(text, HasSubstr("red +5 mm"));
  EXPECT_THAT(text, Not(HasSubstr("sigma")));
  const PlyReadElement vertices = ReadPly(text).elements[0];
  const std::vector<double> ids = vertices.Column("marker_id"), blue = vertices.Column("blue");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] != 44) continue;
    EXPECT_EQ(blue[i], 172);
  }
}

TEST(ComparisonPly, DoesNotFollowTheLocale) {
  const std::string text = Ply(Example());
  const CommaLocale locale;
  EXPECT_EQ(Ply(Example()), text);
}

TEST(ComparisonPly, EqualShapesAreWhite) {
  const UncertainShape boat = WithSigmas(BoatShape());
  AlignmentOptions none;
  none.method = AlignmentMethod::kNone;
  const PlyReadElement vertices =
      ReadPly(Ply(CompareWithShape(boat, boat, BoatLayout(), none))).elements[0];
  for (const double red : vertices.Column("red")) EXPECT_EQ(red, 247);
}

TEST(ComparisonReport, HasTheKeysThatTheReadmeLists) {
  MetricsReport report;
  AddMetrics(Example(0.001), &report);
  std::ostringstream text, csv, json;
  PrintMetrics(report, text);
  WriteMetricsCsv(report, csv);
  WriteMetricsJson(report, json);
  EXPECT_THAT(text.str(), HasSubstr("alignment: reference_part\n"));
  EXPECT_THAT(text.str(), HasSubstr("alignment_by: part hull"));
  EXPECT_THAT(text.str(), HasSubstr("num_markers: 36\n"));
  EXPECT_THAT(text.str(), HasSubstr("distance_mm_max: 20\n"));
  EXPECT_THAT(text.str(), HasSubstr("distance_mm_min: -10\n"));
  EXPECT_THAT(text.str(), HasSubstr("difference_mm_max: 20\n"));
  EXPECT_THAT(text.str(), HasSubstr("num_with_sigma: 36\n"));
  EXPECT_THAT(text.str(), HasSubstr("num_significant: 2\n"));
  EXPECT_THAT(text.str(), HasSubstr("lines: part sail, line h3, distance_mm mean 3.33333"));
  EXPECT_THAT(text.str(), HasSubstr("parts: part hull, distance_mm mean"));
  EXPECT_THAT(text.str(), HasSubstr("scale_difference_percent: "));
  EXPECT_THAT(csv.str(), HasSubstr("markers,0,difference_x_mm,"));
  EXPECT_THAT(csv.str(), HasSubstr("markers,0,significance,"));
  EXPECT_THAT(csv.str(), HasSubstr("reference_from_shape,0,qw,"));
  EXPECT_THAT(json.str(), HasSubstr("\"difference_sigma_z_mm\""));
}

TEST(ComparisonReport, AShapeIsZeroFromItself) {
  const UncertainShape boat = WithSigmas(BoatShape(0.001)),
                       elsewhere{Moved(FarPose(), boat.shape), boat.covariance};
  MetricsReport report;
  AddMetrics(CompareWithShape(elsewhere, boat, BoatLayout(), {}, ""), &report);
  DropRoundingErrors(&report);
  for (const Metric& metric : report.metrics) {
    if (const auto* statistics = std::get_if<Statistics>(&metric.value)) {
      EXPECT_EQ(statistics->min, 0.0) << metric.key;
      EXPECT_EQ(statistics->max, 0.0) << metric.key;
    }
    if (metric.key == "scale_difference_percent") {
      EXPECT_EQ(std::get<double>(metric.value), 0.0);
    }
  }
}

// The second shape lacks a marker, so that the surface of the reference is fitted to fewer.
TEST(ComparisonReport, AReferenceThatASeriesSharesGivesTheSameFigures) {
  const UncertainShape boat = WithSigmas(BoatShape(0.001));
  const SeriesReference shared(boat);
  ComparisonOptions options;
  options.with_deflections = true;
  const auto figures = [&](const UncertainShape& shape, const SeriesReference& reference) {
    const Comparison comparison = Compare("trim", shape, reference, BoatLayout(), options);
    std::ostringstream out;
    WriteMetricsCsv(MakeComparisonReport({comparison}), out);
    WriteDeflectionCsv({{comparison.name, &comparison.deflections}}, out);
    return out.str();
  };
  const FittedSurface& surface = shared.surfaces.Of(BoatLayout().parts.front());
  const MarkerShape fuller = Shifted({33, 34}, {0, 0.02, 0}, boat.shape);
  for (const MarkerShape& shape : {fuller, Without({22}, fuller), fuller}) {
    EXPECT_EQ(figures(WithSigmas(shape), shared), figures(WithSigmas(shape), boat));
  }
  EXPECT_EQ(&surface, &shared.surfaces.Of(BoatLayout().parts.front()));
}

TEST(ComparisonReport, OfASurfaceHasNoVectors) {
  AlignmentOptions none;
  none.method = AlignmentMethod::kNone;
  MetricsReport report;
  AddMetrics(CompareWithMesh(WithSigmas(BoatShape()), MeshDistance(SailMesh()), BoatLayout(), none,
                             "sail"),
             &report);
  std::ostringstream csv;
  WriteMetricsCsv(report, csv);
  EXPECT_THAT(csv.str(), HasSubstr(",,num_beside_surface,0\n"));
  EXPECT_THAT(csv.str(), HasSubstr("markers,0,beside_mm,"));
  EXPECT_THAT(csv.str(), Not(HasSubstr("difference")));
  EXPECT_THAT(csv.str(), Not(HasSubstr("significan")));
}

}  // namespace
}  // namespace velamap
