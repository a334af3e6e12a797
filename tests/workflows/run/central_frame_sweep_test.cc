#include "workflows/run/central_frame_sweep.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "exporters/formats/shape_csv.h"
#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "importer/text/csv.h"
#include "reconstruct/model/model_io.h"
#include "tests/support/error_matchers.h"
#include "tests/support/export_shape.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "workflows/run/pipeline.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CentralFrameSweepTest : public testing::Test {
 protected:
  CentralFrameSweepTest() {
    SyntheticSceneOptions scene_options;
    scene_options.num_frames = 60;
    scene_ = MakeSyntheticScene(scene_options);
    AddNoise({0.2, 0.05, 0.0, 200, 3}, &scene_);
    WriteDatabase("database.db");
    options_.registration.method = RegistrationMethod::kThesis;
    options_.registration.thesis.num_frames = 6;
    options_.registration.thesis.skip = 4;
    options_.registration.thesis.neighborhood = 1;
    options_.adjustment.backend = AdjustmentBackend::kMarkers;
    options_.adjustment.Complete(1);
  }

  void WriteDatabase(const std::string& name) {
    options_.database_path = (dir_ / name).string();
    ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadWriteCreate);
    ColmapDatabase::Transaction transaction(&database);
    const CameraId camera_id = database.AddCamera(scene_.camera);
    for (const FrameDetections& frame : scene_.frames) {
      database.AddImage(camera_id, frame, "test");
    }
    transaction.Commit();
  }

  std::vector<SweepRow> Run() {
    StageClock clock;
    return SweepCentralFrames(options_, scene_.layout, &clock, [](int, int) {});
  }

  std::vector<int> Choose(const std::string& choice) {
    const ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadOnly);
    const auto images = database.ReadImages();
    const auto cameras = database.ReadCameras();
    return ChooseCentralFrames(choice, PoseImages(images, cameras, scene_.layout));
  }

  SyntheticScene scene_;
  TempDir dir_;
  CentralFrameSweepOptions options_;
};

TEST_F(CentralFrameSweepTest, RowsAreWhatSingleRunsGive) {
  options_.central_frames = "24,27,30,33";
  const std::vector<SweepRow> rows = Run();
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_FALSE(rows[0].is_warm);
  for (const SweepRow& row : rows) {
    RegistrationOptions registration = options_.registration;
    registration.central_frame = row.central_frame;
    const SeedResult seed = RegisterDatabase(options_.database_path, scene_.layout, registration);
    Model model = seed.model;
    const AdjustmentResult adjusted =
        AdjustModel(options_.adjustment, scene_.layout, seed.corner_errors, "", &model);
    const ShapeExportReport single = ExportShape(model, scene_.layout, {}, &*adjusted.uncertainty);
    EXPECT_EQ(row.reason, "");
    EXPECT_EQ(row.is_warm, row.central_frame != "24");
    EXPECT_EQ(row.image_name, seed.registration.central_image_name);
    EXPECT_EQ(row.num_images, static_cast<int>(model.images.size()));
    EXPECT_EQ(row.shape.num_markers, single.metrics.num_markers);
    EXPECT_EQ(row.shape.reconstruction_ratio, single.metrics.reconstruction_ratio);
    EXPECT_EQ(row.model.error_px.count, single.model_metrics.error_px.count);
    EXPECT_NEAR(row.model.error_px.mean, single.model_metrics.error_px.mean, 1e-5);
    EXPECT_NEAR(row.model.central_error_px.mean, single.model_metrics.central_error_px.mean, 1e-4);
    EXPECT_NEAR(row.shape.area_error_percent.mean, single.metrics.area_error_percent.mean, 1e-4);
    EXPECT_GT(row.cpu_s, 0.0);
  }
}

TEST_F(CentralFrameSweepTest, NeedsACalibration) {
  {
    ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadWriteCreate);
    database.AddCamera(UnknownCamera(640, 480), false);
  }
  options_.central_frames = "24";
  ExpectThrows<InputError>([&] { Run(); }, {options_.database_path, "without a calibration"});
}

TEST_F(CentralFrameSweepTest, WritesTheModelsAndShapesOfTheRows) {
  options_.central_frames = "30";
  options_.models_path = (dir_ / "models").string();
  const std::vector<SweepRow> rows = Run();
  const Model model = ReadModel((dir_ / "models/frame_000030/sparse").string());
  EXPECT_EQ(static_cast<int>(model.images.size()), rows[0].num_images);
  const MarkerShape shape = ReadShapeCsv((dir_ / "models/frame_000030/shape.csv").string());
  EXPECT_EQ(ComputeShapeMetrics(shape, scene_.layout).num_markers, rows[0].shape.num_markers);
  std::ifstream file(dir_ / "models/frame_000030/shape.json");
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json.at("frame").at("name"), "camera");
  EXPECT_EQ(json.at("num_images"), rows[0].num_images);
  EXPECT_EQ(json.at("num_markers"), rows[0].shape.num_markers);
  EXPECT_EQ(json.at("cameras").size(), 1u);
  EXPECT_TRUE(json.at("files").contains("shape.csv"));
  EXPECT_TRUE(json.at("verdict").contains("level"));
  EXPECT_TRUE(json.at("verdict").contains("reasons"));
}

TEST_F(CentralFrameSweepTest, ReplacesItsOwnModelsAndNoOthers) {
  options_.central_frames = "30";
  options_.models_path = (dir_ / "models").string();
  EXPECT_EQ(Run().at(0).reason, "");
  EXPECT_EQ(Run().at(0).reason, "");
  const auto notes = dir_ / "models/frame_000030/notes.txt";
  std::ofstream(notes) << "of the user";
  ExpectThrows<InputError>([&] { Run(); }, {"frame_000030", "notes.txt"});
  std::filesystem::remove(notes);
  std::ofstream(dir_ / "models/frame_000030/shape.csv") << "of the user";
  ExpectThrows<InputError>([&] { Run(); }, {"shape.csv, which was changed"});
}

TEST_F(CentralFrameSweepTest, NamesThatDifferInTheirExtensionDoNotCollide) {
  options_.central_frames = "30,31";
  options_.models_path = (dir_ / "models").string();
  for (FrameDetections& frame : scene_.frames) {
    if (frame.frame_number == 31) frame.image_name = "frame_000030.png";
  }
  WriteDatabase("other.db");
  const std::vector<SweepRow> rows = Run();
  ASSERT_EQ(rows.size(), 2u);
  for (const SweepRow& row : rows) {
    EXPECT_TRUE(std::filesystem::exists(dir_ / ("models/" + row.image_name + "/shape.csv")))
        << row.image_name << row.reason;
  }
}

TEST_F(CentralFrameSweepTest, FrameWithoutAResultIsARowWithAReason) {
  options_.central_frames = "30,31";
  options_.registration.min_num_inliers = 1000;
  EXPECT_THAT(Run().at(1).reason, HasSubstr("1000 are needed"));
  options_.registration.min_num_inliers = 2;
  options_.adjustment.markers.max_mean_error_px = 1e-6;
  const std::vector<SweepRow> rows = Run();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_THAT(rows[0].reason, HasSubstr("mean reprojection error"));
  EXPECT_FALSE(rows[1].is_warm);
  EXPECT_EQ(BestRow(rows), -1);
}

TEST_F(CentralFrameSweepTest, GlobalRegistrationHasNoCentralFrame) {
  options_.registration.method = RegistrationMethod::kGlobal;
  EXPECT_THROW(Run(), InputError);
}

TEST_F(CentralFrameSweepTest, Choices) {
  EXPECT_EQ(Choose("all").size(), 60u);
  EXPECT_THAT(Choose("every:25"), ElementsAre(0, 25, 50));
  EXPECT_THAT(Choose("30,frame_000002.jpg,30"), ElementsAre(2, 30));
  for (const std::string bad : {"", "every:0", "every:x", "every:", "30,99", "30,,31", "some"}) {
    EXPECT_THROW(Choose(bad), InputError) << bad;
  }
}

TEST(CentralFrameSweep, BestRowAndTable) {
  std::vector<SweepRow> rows(4);
  rows[0].shape.reconstruction_ratio = 0.9;
  rows[0].shape.area_error_mm2.mean = 5;
  rows[1] = rows[0];
  rows[1].shape.area_error_mm2.mean = 4;
  rows[2].reason = "says \"no\"";
  rows[3].shape.reconstruction_ratio = 0.8;
  EXPECT_EQ(BestRow(rows), 1);
  rows[2].central_frame = rows[2].image_name = "c,am \"00\".jpg";
  std::stringstream out;
  WriteSweepCsv({rows[1], rows[2]}, out);
  const std::vector<CsvRecord> records = ReadCsv(out, "sweep.csv");
  ASSERT_EQ(records.size(), 3u);
  for (const CsvRecord& record : records) EXPECT_EQ(record.fields.size(), 14u);
  EXPECT_EQ(records[2].fields[0], "c,am \"00\".jpg");
  EXPECT_EQ(records[2].fields[1], "c,am \"00\".jpg");
  EXPECT_EQ(records[2].fields[13], "says \"no\"");
}

}  // namespace
}  // namespace velamap
