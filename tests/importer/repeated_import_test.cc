// Imports that are repeated: with more pictures, with other options or with more threads.

#include <fstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/importer/marker_importer_fixture.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

TEST_F(MarkerImporterTest, RerunAddsWhatIsMissingAndNothingElse) {
  WritePicture("1.png", 0, {1, 2});
  WritePicture("3.png", 1, {1, 2});
  ImportMarkers(options_);
  ImportReport report = ImportMarkers(options_);
  EXPECT_EQ(report.num_frames_read, 0);
  EXPECT_EQ(report.num_images_added, 0);
  EXPECT_EQ(report.num_images_present, 2);
  EXPECT_EQ(report.num_pairs, 1);
  // The estimate from the first images holds for later ones.
  ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadWriteCreate);
  FormationEstimate formation = database.ReadFormation().value();
  formation.parameters.gamma = 1.234;
  database.WriteFormation(formation);
  WritePicture("2.png", 2, {1, 2});
  report = ImportMarkers(options_);
  EXPECT_EQ(report.num_images_added, 1);
  EXPECT_EQ(report.num_pairs, 3);
  EXPECT_EQ(ReadImages().size(), 3u);
  EXPECT_EQ(database.ReadFormation()->parameters.gamma, 1.234);
}

TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothing) {
  for (int i = 0; i < 8; ++i) WritePicture(std::to_string(i) + ".png", i, {1, 2, 3});
  options_.num_threads = 1;
  ImportMarkers(options_);
  const std::string bytes = DatabaseBytes();
  fs::remove(options_.database_path);
  options_.num_threads = 4;
  ImportMarkers(options_);
  EXPECT_EQ(DatabaseBytes(), bytes);
}

// Markers 5 and 6 are visible in some of the frames only.
TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothingWithAPriorShape) {
  options_.detection.estimate_formation = false;
  options_.image_path = dir_ / "video.avi";
  {
    cv::VideoWriter writer(options_.image_path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           cv::Size(640, 480));
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 40; ++i) {
      std::vector<DrawnMarker> drawn;
      for (int id = 1; id <= 6; ++id) {
        if (id > 4 && i % 20 < 5) continue;
        drawn.push_back({id, 30 + 200 * ((id - 1) % 3) + i, 60 + 220 * ((id - 1) / 3), 72});
      }
      writer << DrawMarkers(LoadDictionary("DICT_4X4_50").aruco, cv::Size(640, 480), drawn);
    }
  }
  options_.camera = {CameraModel::kPinhole, 640, 480, {600, 600, 320, 240}};
  for (int id = 1; id <= 6; ++id) {
    const double x = 0.2 * ((id - 1) % 3), y = 0.22 * ((id - 1) / 3);
    options_.prior_shape[id] = {Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x + 0.072, y, 0),
                                Eigen::Vector3d(x + 0.072, y + 0.072, 0),
                                Eigen::Vector3d(x, y + 0.072, 0)};
  }
  std::string bytes;
  for (const int num_threads : {1, 2, 5}) {
    fs::remove(options_.database_path);
    options_.num_threads = num_threads;
    const ImportReport report = ImportMarkers(options_);
    EXPECT_EQ(report.num_markers, 40 * 4 + 30 * 2);
    EXPECT_EQ(report.prior_shape_agreement.num_agreeing, report.prior_shape_agreement.num_known);
    EXPECT_GT(report.prior_shape_agreement.num_agreeing, 40 * 4);
    if (num_threads == 1) bytes = DatabaseBytes();
    EXPECT_EQ(DatabaseBytes(), bytes) << num_threads;
  }
}

TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothingInATrackedVideo) {
  WriteVideo(40);
  const auto run = [&](int num_threads, SearchMode search) {
    fs::remove(options_.database_path);
    options_.num_threads = num_threads;
    options_.detection.search = search;
    ImportMarkers(options_);
    return DatabaseBytes();
  };
  const std::string bytes = run(1, SearchMode::kTracked);
  for (const int num_threads : {2, 5}) EXPECT_EQ(run(num_threads, SearchMode::kTracked), bytes);
  const std::vector<DatabaseImage> tracked = ReadImages();
  run(2, SearchMode::kExhaustive);
  const std::vector<DatabaseImage> exhaustive = ReadImages();
  ASSERT_EQ(tracked.size(), exhaustive.size());
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    ASSERT_EQ(tracked[i].detections.markers.size(), exhaustive[i].detections.markers.size());
    for (std::size_t m = 0; m < tracked[i].detections.markers.size(); ++m) {
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        EXPECT_LT((tracked[i].detections.markers[m].corners_in_image_px[c] -
                   exhaustive[i].detections.markers[m].corners_in_image_px[c])
                      .norm(),
                  0.002);
      }
    }
  }
}

// A rope crosses marker 2 from the seventh frame on, where it is found only because it is tracked.
TEST_F(MarkerImporterTest, AVideoThatIsImportedInPartsGivesTheSameImages) {
  options_.image_path = dir_ / "video.avi";
  {
    cv::VideoWriter writer(options_.image_path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           kSize);
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 30; ++i) {
      cv::Mat picture =
          Picture(i, i % 6 < 5 ? std::vector<int>{1, 2} : std::vector<int>{}, "DICT_4X4_50");
      const int rope_x = 151 + i;
      if (i > 5) cv::line(picture, {rope_x, 0}, {rope_x, kSize.height}, cv::Scalar::all(0), 4);
      writer << picture;
    }
  }
  options_.detection.estimate_formation = false;
  ImportMarkers(options_);
  const std::vector<DatabaseImage> whole = ReadImages();
  fs::remove(options_.database_path);
  for (const int last_frame : {12, 14, -1}) {
    options_.video.last_frame = last_frame;
    ImportMarkers(options_);
  }
  const std::vector<DatabaseImage> in_parts = ReadImages();
  ASSERT_EQ(in_parts.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const FrameDetections& detections = in_parts[i].detections;
    EXPECT_EQ(detections.image_name, whole[i].detections.image_name);
    ASSERT_EQ(detections.markers.size(), whole[i].detections.markers.size());
    for (std::size_t m = 0; m < detections.markers.size(); ++m) {
      EXPECT_EQ(detections.markers[m].marker_id, whole[i].detections.markers[m].marker_id);
      EXPECT_EQ(detections.markers[m].corners_in_image_px,
                whole[i].detections.markers[m].corners_in_image_px);
    }
  }
}

TEST_F(MarkerImporterTest, OtherFramesTellTheRotationOfASymmetricMarker) {
  // Marker 2 looks the same upside down. Marker 0 has its orientation and marker 1 is turned by 90
  // degrees, so that the frame without marker 0 does not tell how marker 2 is oriented.
  std::ofstream(dir_ / "nine_bits.yml") << "%YAML:1.0\n---\nnmarkers: 3\nmarkersize: 3\n"
                                           "maxCorrectionBits: 0\nmarker_0: \"110100001\"\n"
                                           "marker_1: \"111000100\"\nmarker_2: \"100000001\"\n";
  options_.layout = MakeLayout(dir_ / "nine_bits.yml", 0.1);
  const auto write = [&](int idx, bool with_first) {
    std::vector<DrawnMarker> markers = {{1, 115 + idx, 40, 70}, {2, 210 + idx, 40 + idx, 70}};
    if (with_first) markers.push_back({0, 20 + idx, 40, 70});
    cv::Mat picture = DrawMarkers(LoadDictionary(options_.layout.dictionary).aruco, kSize, markers);
    const cv::Mat across = picture(cv::Rect(115 + idx, 40, 70, 70));
    cv::Mat turned;
    cv::rotate(across, turned, cv::ROTATE_90_CLOCKWISE);
    turned.copyTo(across);
    cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
    cv::imwrite(dir_ / ("images/" + std::to_string(idx) + ".png"), picture);
  };
  const auto num_markers = [&](std::size_t image_idx) {
    return ReadImages().at(image_idx).detections.markers.size();
  };
  write(0, false);
  write(1, true);
  EXPECT_EQ(ImportMarkers(options_).num_rejected, 1);
  EXPECT_EQ(num_markers(0), 1u);
  for (int i = 2; i < 5; ++i) write(i, true);
  const ImportReport report = ImportMarkers(options_);
  EXPECT_EQ(report.num_images_present, 2);
  EXPECT_EQ(report.num_markers, 10);  // nine in the new pictures, one in an older one
  EXPECT_EQ(report.num_pairs, 10);
  ASSERT_EQ(num_markers(0), 2u);
  const MarkerDetection marker = ReadImages()[0].detections.markers[1];
  EXPECT_EQ(marker.marker_id, 2);
  EXPECT_NEAR(marker.corners_in_image_px[0].x(), 210, 0.1);
  EXPECT_NEAR(marker.corners_in_image_px[0].y(), 40, 0.1);
}

TEST_F(MarkerImporterTest, OtherWayOfDetectionOrCameraIsRefused) {
  WritePicture("1.png", 0, {1, 2});
  ImportMarkers(options_);
  MarkerImporterOptions other = options_;
  other.detection.error_correction_rate = 0.5;
  ExpectThrows<InputError>([&] { ImportMarkers(other); },
                           {options_.database_path, "other detection options",
                            "(error_correction_rate=0.3; this run has error_correction_rate=0.5)"});
  other = options_;
  LayoutPart part;
  part.name = "sail";
  part.marker_ids = {1, 2};
  other.layout.parts = {part};
  ExpectThrows<InputError>([&] { ImportMarkers(other); }, {"another layout"});
  other = options_;
  other.camera->params[0] = 301;
  ExpectThrows<InputError>([&] { ImportMarkers(other); },
                           {options_.database_path, "a calibration other than", "camera.yml"});
  EXPECT_EQ(ReadImages().size(), 1u);
}

TEST_F(MarkerImporterTest, FailedRunLeavesAnExistingDatabaseAlone) {
  WritePicture("1.png", 0, {1, 2});
  ImportMarkers(options_);
  options_.image_path = dir_ / "none";
  EXPECT_THROW(ImportMarkers(options_), InputError);
  EXPECT_EQ(ReadImages().size(), 1u);
}

TEST_F(MarkerImporterTest, FailedFirstRunLeavesALinkToADatabaseAlone) {
  fs::create_symlink("elsewhere.db", options_.database_path);
  WritePicture("1.png", 0, {});
  EXPECT_THROW(ImportMarkers(options_), DataError);
  EXPECT_TRUE(fs::is_symlink(options_.database_path));
  EXPECT_FALSE(fs::exists(dir_ / "elsewhere.db"));
  WritePicture("2.png", 0, {1, 2});
  ImportMarkers(options_);
  EXPECT_TRUE(fs::is_symlink(options_.database_path));
  EXPECT_TRUE(fs::exists(dir_ / "elsewhere.db"));
}

TEST_F(MarkerImporterTest, DamagedFramesAreCountedAgainByALaterRun) {
  WriteVideo(10);
  {
    std::fstream video(options_.image_path, std::ios::in | std::ios::out | std::ios::binary);
    video.seekp(static_cast<std::streamoff>(fs::file_size(options_.image_path) / 2));
    video << std::string(300, '\xff');
  }
  const ImportReport report = ImportMarkers(options_);
  EXPECT_GE(report.num_frames_damaged, 1);
  EXPECT_LT(report.num_frames_read, 10);
  const ImportReport again = ImportMarkers(options_);
  EXPECT_EQ(again.num_images_added, 0);
  EXPECT_EQ(again.num_frames_damaged, report.num_frames_damaged);
}

}  // namespace
}  // namespace velamap
