#include "exporters/shape_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/exporters/example_model.h"
#include "tests/exporters/golden_file.h"
#include "tests/support/export_shape.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;

template <typename Source>
json JsonOf(const Source& source) {
  MetricsReport report;
  AddMetrics(source, &report);
  return json::parse(Written([&](std::ostream& out) { WriteMetricsJson(report, out); }));
}

TEST(ShapeReport, ShapeMetricsAndTheirMarkers) {
  MarkerShape shape;
  shape.markers = {SquareMarker(1, 0.103), SquareMarker(121, 0.049)};
  const json report = JsonOf(ComputeShapeMetrics(shape, ExampleLayout()));
  EXPECT_EQ(report["num_markers"], 2);
  EXPECT_EQ(report["num_layout_markers"], 8);
  EXPECT_EQ(report["reconstruction_ratio"], 0.25);
  EXPECT_EQ(report["num_sail_markers"], 6);
  EXPECT_NEAR(report["sail_reconstruction_ratio"].get<double>(), 1.0 / 6.0, 1e-15);
  EXPECT_EQ(report["missing_marker_ids"], (json{2, 3, 4, 5, 6, 120}));
  EXPECT_NEAR(report["area_error_mm2_max"].get<double>(), 609.0, 1e-8);
  EXPECT_NEAR(report["area_error_percent_mean"].get<double>(), 5.025, 1e-10);
  EXPECT_NEAR(report["side_error_mm_median"].get<double>(), 2.0, 1e-10);
  ASSERT_EQ(report["markers"].size(), 2u);
  EXPECT_EQ(report["markers"][1]["marker_id"], 121);
  EXPECT_NEAR(report["markers"][1]["area_error_percent"].get<double>(), 3.96, 1e-10);
}

TEST(ShapeReport, WithoutAListOfMarkersThereAreNoKeysOfIt) {
  const json report = JsonOf(ComputeShapeMetrics(MarkerShape(), MakeLayout("DICT_4X4_50", 0.1)));
  EXPECT_EQ(report["num_markers"], 0);
  EXPECT_EQ(report["area_error_mm2_count"], 0);
  for (const char* key : {"num_layout_markers", "reconstruction_ratio", "missing_marker_ids",
                          "num_sail_markers", "sail_reconstruction_ratio"}) {
    EXPECT_FALSE(report.contains(key)) << key;
  }
}

TEST(ShapeReport, ComparisonIsInMillimetres) {
  ReferenceMetrics comparison;
  comparison.num_points = 2;
  comparison.distance_m = ComputeStatistics({0.001, 0.003});
  comparison.scale = 1.0125;
  comparison.distance_after_scaling_m = ComputeStatistics({0.0005, 0.0005});
  comparison.markers = {{17, 2, 0.002, 0.0005}};
  EXPECT_FALSE(JsonOf(comparison).contains("distance_sigma_mm"));
  EXPECT_FALSE(JsonOf(comparison).contains("distance_after_scaling_sigma_mm"));
  comparison.distance_sigma_m = 0.004;
  comparison.distance_after_scaling_sigma_m = 0.003;
  const json report = JsonOf(comparison);
  EXPECT_NEAR(report["distance_sigma_mm"].get<double>(), 4.0, 1e-12);
  EXPECT_NEAR(report["distance_after_scaling_sigma_mm"].get<double>(), 3.0, 1e-12);
  EXPECT_EQ(report["num_points"], 2);
  EXPECT_EQ(report["distance_mm_count"], 2);
  EXPECT_NEAR(report["distance_mm_mean"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(report["distance_mm_std"].get<double>(), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(report["distance_mm_median"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(report["distance_mm_min"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(report["distance_mm_rms"].get<double>(), std::sqrt(5.0), 1e-12);
  EXPECT_EQ(report["scale"], 1.0125);
  EXPECT_NEAR(report["scale_error_percent"].get<double>(), 1.25, 1e-12);
  EXPECT_NEAR(report["distance_after_scaling_mm_max"].get<double>(), 0.5, 1e-12);
  EXPECT_EQ(report["reference_markers"][0]["marker_id"], 17);
  EXPECT_EQ(report["reference_markers"][0]["distance_mm"], 2.0);
}

TEST(ShapeReport, AdjacentDistancesHaveErrorsWithoutSignAndDeviationsWithIt) {
  const json report = JsonOf(std::vector<AdjacentDistance>{
      {1, 2, 0.198, 0.2, 0.003}, {2, 3, 0.503, 0.5}, {3, 4, 0.001, 0.0}});
  EXPECT_NEAR(report["adjacent_distances"][0]["distance_sigma_mm"].get<double>(), 3.0, 1e-12);
  EXPECT_FALSE(report["adjacent_distances"][1].contains("distance_sigma_mm"));
  EXPECT_EQ(report["adjacent_distance_error_mm_count"], 3);
  EXPECT_NEAR(report["adjacent_distance_error_mm_mean"].get<double>(), 2.0, 1e-9);
  EXPECT_EQ(report["adjacent_distance_deviation_percent_count"], 2);
  EXPECT_NEAR(report["adjacent_distance_deviation_percent_min"].get<double>(), -1.0, 1e-9);
  EXPECT_NEAR(report["adjacent_distance_deviation_percent_max"].get<double>(), 0.6, 1e-9);
  EXPECT_EQ(report["adjacent_distances"][1]["marker_id2"], 3);
  EXPECT_EQ(report["adjacent_distances"][1]["reference_distance_mm"], 500.0);
}

TEST(ShapeReport, PlanesAreATableOfPartsAndOneOfPairs) {
  PartPlane wall;
  wall.part = "wall";
  wall.num_markers = 3;
  wall.corner_distance_mm = ComputeStatistics({0.1, 0.3});
  wall.normal_spread_deg = ComputeStatistics({1.0});
  PartPlane floor = wall;
  floor.part = "floor";
  floor.normal = Eigen::Vector3d::UnitX();
  PartPlane shelf = wall;
  shelf.part = "shelf";
  shelf.centroid_m.z() = 0.25;
  const json report = JsonOf(std::vector<PartPlane>{wall, floor, shelf});
  EXPECT_EQ(report["parts"][0]["part"], "wall");
  EXPECT_EQ(report["parts"][0]["plane_error_mm_count"], 0);
  EXPECT_EQ(report["parts"][0]["corner_plane_error_mm_max"], 0.3);
  EXPECT_EQ(report["parts"][0]["normal_spread_deg_mean"], 1.0);
  EXPECT_NEAR(report["part_pairs"][0]["angle_deg"].get<double>(), 90.0, 1e-12);
  EXPECT_FALSE(report["part_pairs"][0].contains("distance_mm"));
  EXPECT_NEAR(report["part_pairs"][1]["distance_mm"].get<double>(), 250.0, 1e-9);
}

TEST(ShapeReport, ExporterWritesWhatItReports) {
  const TempDir dir;
  Model model = ExampleModel();
  AddImageNoise(0.5, 7, &model);
  ShapeExporterOptions options;
  options.shape_output_path = dir / "shape";
  const ShapeExportReport expected = ExportShape(model, ExampleLayout(), options);
  const json report = json::parse(ReadBytes(dir / "shape" / "metrics.json"));
  const Statistics& error_px = expected.model_metrics.error_px;
  EXPECT_EQ(report["reprojection_error_px_std"], error_px.standard_deviation);
  EXPECT_EQ(report["reprojection_error_px_min"], error_px.min);
  EXPECT_EQ(report["central_image_name"], "image1.jpg");
  EXPECT_EQ(report["central_reprojection_error_px_mean"],
            expected.model_metrics.central_error_px.mean);
  EXPECT_EQ(report["scale_m_per_unit"], expected.scale.m_per_unit);
  EXPECT_EQ(report["image_marker_ratio_mean"], 1.0);
  EXPECT_EQ(report["images"].size(), 3u);
  EXPECT_EQ(report["markers"].size(), 8u);
  EXPECT_EQ(report["parts"].size(), 2u);
  EXPECT_EQ(report["part_pairs"].size(), 1u);
  const std::string csv = ReadBytes(dir / "shape" / "metrics.csv");
  EXPECT_THAT(csv, HasSubstr(",,reprojection_error_px_count,96\n"));
  EXPECT_THAT(csv, HasSubstr("images,2,image_name,image3.jpg\n"));
}

TEST(ShapeReport, UncertaintySaysWhatWasLeftInAndWhatItRestsOn) {
  AdjustmentUncertainty uncertainty;
  uncertainty.share_above_4_sigma = 0.002;
  uncertainty.variance_factor = 2.25;
  uncertainty.correlation_factor = 1.25;
  const auto report = JsonOf(uncertainty);
  EXPECT_NEAR(report["corners_above_4_sigma_percent"].get<double>(), 0.2, 1e-12);
  EXPECT_NEAR(report["corner_sigma_factor"].get<double>(), 1.5, 1e-12);
  EXPECT_EQ(report["correlation_factor"].get<double>(), 1.25);
}

}  // namespace
}  // namespace velamap
