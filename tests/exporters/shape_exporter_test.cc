#include "exporters/shape_exporter.h"

#include <random>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "exporters/exchange/alicevision_scene.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/formats/shape_ply.h"
#include "exporters/scale/metric_shape.h"
#include "exporters/scale/scale_csv.h"
#include "importer/base/error.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/model_io.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"
#include "tests/exporters/exported_files.h"
#include "tests/exporters/golden_file.h"
#include "tests/support/export_shape.h"
#include "tests/support/scoped_date.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;
using testing::UnorderedElementsAre;

// Distances between all corners, which do not depend on the world frame.
std::vector<double> Lengths(const MarkerShape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (const ShapeMarker& marker : shape.markers) {
    for (const auto& x : marker.x_in_shape_m) points.push_back(x.value());
  }
  std::vector<double> lengths;
  for (const auto& a : points) {
    for (const auto& b : points) lengths.push_back((a - b).norm());
  }
  return lengths;
}

// The same model in another valid order: the central image stays the first one.
Model Shuffled(Model model, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto shuffle = [&](auto& values, std::size_t first = 0) {
    for (std::size_t i = values.size(); i > first + 1; --i) {
      std::swap(values[i - 1], values[first + random() % (i - first)]);
    }
  };
  shuffle(model.images, 1);
  for (ModelImage& image : model.images) {
    std::vector<std::uint32_t> new_idx(image.points2D.size());
    for (std::uint32_t i = 0; i < new_idx.size(); ++i) new_idx[i] = i;
    shuffle(new_idx);
    std::vector<Point2D> points2D(new_idx.size());
    for (std::uint32_t i = 0; i < new_idx.size(); ++i) points2D[new_idx[i]] = image.points2D[i];
    image.points2D = points2D;
    for (auto& [id, point] : model.points3D) {
      for (TrackElement& element : point.track) {
        if (element.image_id == image.image_id) element.point2D_idx = new_idx[element.point2D_idx];
      }
    }
  }
  for (auto& [id, point] : model.points3D) shuffle(point.track);
  CheckModel(model);
  return model;
}

TEST(ShapeExporter, AnExactModelGivesTheExactLengths) {
  const std::vector<double> truth = Lengths(ShapeFromModel(ExampleModel(), ExampleLayout()));
  for (const double scale : {1.0, 1e-3, 0.37, 88.0}) {
    Model model = ExampleModel();
    TransformModel(ExampleSim3(scale), &model);
    const ShapeExportReport report = ExportShape(model, ExampleLayout(), {});
    const std::vector<double> lengths = Lengths(report.shape);
    ASSERT_EQ(lengths.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(lengths[i], truth[i], 1e-12);
    EXPECT_LT(report.metrics.side_error_mm.max, 1e-9);
    EXPECT_LT(report.model_metrics.error_px.max, 1e-8);
  }
}

TEST(ShapeExporter, ANoisyModelExportsTheSameInEveryWorldFrame) {
  Model model = ExampleModel();
  std::mt19937 random(5);
  for (auto& [id, point] : model.points3D) {
    for (double& x : point.x_in_world) x += 1e-3 * (random() / 4294967295.0 - 0.5);
  }
  const ShapeExportReport expected = ExportShape(model, ExampleLayout(), {});
  EXPECT_GT(expected.metrics.side_error_mm.mean, 0.1);
  TransformModel(ExampleSim3(12.5), &model);
  const ShapeExportReport report = ExportShape(model, ExampleLayout(), {});
  const auto lengths = Lengths(report.shape), expected_lengths = Lengths(expected.shape);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(lengths[i], expected_lengths[i], 1e-12);
  }
  EXPECT_NEAR(report.metrics.area_error_mm2.max, expected.metrics.area_error_mm2.max, 1e-8);
  EXPECT_NEAR(report.scale.relative_spread, expected.scale.relative_spread, 1e-12);
}

TEST(ShapeExporter, OrderChangesNoByte) {
  const ScopedDate date("1700000000");
  const TempDir dir;
  Model model = ExampleModel();
  AddImageNoise(0.5, 3, &model);
  ExportShape(model, ExampleLayout(), OptionsIn(dir));
  const auto expected = BytesIn(dir / "shape");
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    ExportShape(Shuffled(model, seed), ExampleLayout(), OptionsIn(dir));
    EXPECT_EQ(BytesIn(dir / "shape"), expected);
  }
}

TEST(ShapeExporter, LocaleChangesNoByte) {
  const ScopedDate date("1700000000");
  const TempDir dir;
  ExportShape(ExampleModel(), ExampleLayout(), OptionsIn(dir));
  const auto expected = BytesIn(dir / "shape");
  const CommaLocale locale;
  ExportShape(ExampleModel(), ExampleLayout(), OptionsIn(dir));
  EXPECT_EQ(BytesIn(dir / "shape"), expected);
}

TEST(ShapeExporter, FilesHoldWhatTheReportSays) {
  const TempDir dir;
  Model model = ExampleModel();
  TransformModel(ExampleSim3(0.2), &model);
  for (const bool ascii : {false, true}) {
    ShapeExporterOptions options = OptionsIn(dir);
    options.files.ascii_ply = ascii;
    const ShapeExportReport report = ExportShape(model, ExampleLayout(), options);
    const PlyFormat format = ascii ? PlyFormat::kAscii : PlyFormat::kBinaryLittleEndian;
    const fs::path shape = dir / "shape";
    EXPECT_THAT(FilesIn(shape),
                IsSupersetOf({"shape.csv", "shape.ply", "markers.ply", "scale.csv", "metrics.csv",
                              "metrics.json", "shape.json", "surface.step"}));
    const std::string frame = FrameText(report.frame);
    const auto csv = [&](std::ostream& out) { WriteShapeCsv(report.shape, out); };
    const auto scale = [&](std::ostream& out) { WriteScaleCsv(report.scale, out); };
    const auto markers = [&](std::ostream& out) {
      WriteMarkersPly(report.shape, format, out, frame);
    };
    const auto points = [&](std::ostream& out) {
      WritePointsPly(report.shape, model, format, out,
                     frame);  // only colours are taken from the model
    };
    EXPECT_EQ(ReadBytes(shape / "shape.csv"), Written(csv));
    EXPECT_EQ(ReadBytes(shape / "scale.csv"), Written(scale));
    EXPECT_EQ(ReadBytes(shape / "markers.ply"), Written(markers));
    EXPECT_EQ(ReadBytes(shape / "shape.ply"), Written(points));
    const std::string head = ReadBytes(shape / "surface.ply").substr(0, 20);
    EXPECT_EQ(head.find("ascii") != std::string::npos, ascii) << head;
  }
}

TEST(ShapeExporter, OtherProgramsGetTheShapeInItsFrameIfAsked) {
  const TempDir dir;
  ShapeExporterOptions options = OptionsIn(dir);
  ExportShape(ExampleModel(), ExampleLayout(), options);
  const std::set<std::string> unasked = FilesIn(dir / "shape");
  options.metashape = options.alicevision = true;
  const ShapeExportReport report = ExportShape(ExampleModel(), ExampleLayout(), options);
  std::set<std::string> expected = {"metashape_markers.xml", "metashape_reference.csv",
                                    "alicevision.sfm"};
  expected.insert(unasked.begin(), unasked.end());
  EXPECT_EQ(FilesIn(dir / "shape"), expected);
  EXPECT_EQ(unasked.size() + 3, expected.size());
  const auto scene = [&](std::ostream& out) { WriteAliceVisionScene(report.metric_model, out); };
  EXPECT_EQ(ReadBytes(dir / "shape" / "alicevision.sfm"), Written(scene));
}

TEST(ShapeExporter, ShapeJsonListsAllFilesBesideIt) {
  const TempDir dir;
  ShapeExporterOptions options = OptionsIn(dir);
  options.metashape = options.alicevision = true;
  options.sail.sections.heights_m = {0.1};
  ExportShape(ExampleModel(), ExampleLayout(), options);
  const auto root = nlohmann::json::parse(ReadBytes(dir / "shape" / "shape.json"));
  std::set<std::string> listed = {".velamap", "shape.json"};
  for (const auto& [name, content] : root.at("files").items()) listed.insert(name);
  EXPECT_EQ(listed, FilesIn(dir / "shape"));
  EXPECT_EQ(root.at("num_markers"), 8);
}

TEST(ShapeExporter, TheModelIsMetricAndHasTrueErrorsInBothFormats) {
  const TempDir dir;
  Model model = ExampleModel();
  AddImageNoise(0.5, 7, &model);
  TransformModel(ExampleSim3(40.0), &model);
  for (auto& [id, point] : model.points3D) point.mean_error_px = 99.0;  // stale
  const ShapeExportReport report = ExportShape(model, ExampleLayout(), OptionsIn(dir));
  EXPECT_THAT(FilesIn(dir / "0"),
              UnorderedElementsAre(".velamap", "cameras.bin", "images.bin", "points3D.bin",
                                   "cameras.txt", "images.txt", "points3D.txt"));
  const Model from_binary = ReadModel(dir / "0");
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    fs::remove(dir / "0" / name);
  }
  const Model from_text = ReadModel(dir / "0");
  for (const Model& written : {from_binary, from_text}) {
    const MarkerShape shape = ShapeFromModel(written, ExampleLayout());
    EXPECT_EQ(Lengths(shape), Lengths(report.shape));
    double sum = 0.0;
    for (const auto& [id, point] : written.points3D) sum += point.mean_error_px;
    // Every image sees every point, so that the mean over points equals the mean over observations.
    EXPECT_NEAR(sum / written.points3D.size(), report.model_metrics.error_px.mean, 1e-12);
    EXPECT_EQ(written.images.size(), 3u);
    EXPECT_EQ(written.images[0].image_id, model.images[0].image_id);
  }
  EXPECT_GT(report.model_metrics.error_px.mean, 0.1);
}

TEST(ShapeExporter, TheInputModelIsNotNeededToBeWhole) {
  Model model = ExampleModel();
  model.points3D.erase(Point3DIdFromCorner({6, 2}));
  const ShapeExportReport report = ExportShape(model, ExampleLayout(), {});
  EXPECT_THAT(report.metrics.missing_marker_ids, ElementsAre(6));
  EXPECT_EQ(report.metrics.num_markers, 7);
  EXPECT_NEAR(report.scale.m_per_unit, 1.0, 1e-12);
}

TEST(ShapeExporter, WithoutAScaleNothingIsWritten) {
  const TempDir dir;
  Model model = ExampleModel();
  for (const int marker_id : {1, 2, 3, 4, 5, 6, 120, 121}) {
    model.points3D.erase(Point3DIdFromCorner({marker_id, 1}));
  }
  EXPECT_THROW(ExportShape(model, ExampleLayout(), OptionsIn(dir)), DataError);
  EXPECT_TRUE(FilesIn(dir.path()).empty());
}

TEST(ShapeExporter, AMetricModelIsNotScaledAndKeepsItsUncertainty) {
  const TempDir dir;
  Model model = ExampleModel();
  AddImageNoise(0.5, 7, &model);
  TransformModel(ExampleSim3(1.01), &model);  // the markers' sides do not count any more
  const AdjustmentUncertainty uncertainty = ExampleUncertainty(model);
  ShapeExporterOptions options = OptionsIn(dir);
  options.frame = FrameChoice();  // as it is
  const ShapeExportReport report = ExportShape(model, ExampleLayout(), options, &uncertainty);
  EXPECT_EQ(report.scale.m_per_unit, 1.0);
  EXPECT_EQ(*report.scale.relative_sigma, uncertainty.relative_scale_sigma);
  EXPECT_EQ(report.audit.markers.size(), 8u);
  EXPECT_NEAR(report.audit.deviation, -0.01, 0.003);
  const Model written = ReadModel(dir / "0");
  for (const auto& [id, point] : model.points3D) {
    EXPECT_EQ(written.points3D.at(id).x_in_world, point.x_in_world);
  }
  ASSERT_TRUE(HasUncertainty(dir / "0"));
  const AdjustmentUncertainty kept = ReadUncertainty(dir / "0");
  EXPECT_EQ(kept.points.factor, uncertainty.points.factor);
  EXPECT_EQ(kept.variance_factor, uncertainty.variance_factor);

  const MarkerShape shape = ReadShapeCsv(dir / "shape" / "shape.csv");
  const Eigen::Vector3d expected = PointCovarianceOf(uncertainty.points, 23).diagonal().cwiseSqrt();
  EXPECT_LT((*shape.markers[1].sigma_m[3] - expected).norm(), 1e-15);
  EXPECT_TRUE(shape.markers[1].sigma_m[0].has_value());
  EXPECT_THAT(ReadBytes(dir / "shape" / "shape.ply"), HasSubstr("property float sigma\n"));
  EXPECT_THAT(ReadBytes(dir / "shape" / "markers.ply"), HasSubstr("property float sigma\n"));
  const std::string metrics = ReadBytes(dir / "shape" / "metrics.csv");
  for (const char* key : {"scale_sigma_percent", "area_sigma_mm2", "side_sigma_mm",
                          "mean_side_sigma_mm", "angle_sigma_deg"}) {
    EXPECT_THAT(metrics, HasSubstr(std::string(",") + key + ",")) << key;
  }
}

TEST(ShapeExporter, WithoutAnUncertaintyThereAreNoSigmasOfLengths) {
  const TempDir dir;
  AdjustmentUncertainty uncertainty = ExampleUncertainty(ExampleModel());
  ExportShape(ExampleModel(), ExampleLayout(), OptionsIn(dir), &uncertainty);
  Model model = ExampleModel();
  AddImageNoise(0.5, 7, &model);
  ExportShape(model, ExampleLayout(), OptionsIn(dir));  // in the place of the one with
  EXPECT_FALSE(HasUncertainty(dir / "0"));
  const std::string metrics = ReadBytes(dir / "shape" / "metrics.csv");
  for (const char* key : {"area_sigma_mm2", "side_sigma_mm", "angle_sigma_deg"}) {
    EXPECT_THAT(metrics, Not(HasSubstr(key))) << key;
  }
  // Sigmas of the scale follow from the markers and their images.
  EXPECT_THAT(metrics, HasSubstr(",scale_sigma_percent,"));
  EXPECT_THAT(metrics, HasSubstr("scale_parts,0,deviation_from_others_sigma_percent,"));
}

}  // namespace
}  // namespace velamap
