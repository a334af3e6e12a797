#include "importer/marker_importer.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/dictionary.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

const cv::Size kSize(320, 200);

// Draws markers that move by a pixel or two from picture to picture.
cv::Mat Picture(int idx, const std::vector<int>& ids, const std::string& dictionary) {
  std::vector<DrawnMarker> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    markers.push_back({ids[i], 20 + 95 * static_cast<int>(i) + idx, 40 + 2 * idx, 72});
  }
  cv::Mat picture = DrawMarkers(LoadDictionary(dictionary).aruco, kSize, markers);
  cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
  return picture;
}

// A folder of pictures or a video, and the options to import it.
class MarkerImporterTest : public testing::Test {
 protected:
  MarkerImporterTest() {
    fs::create_directory(dir_ / "images");
    options_.image_path = dir_ / "images";
    options_.database_path = dir_ / "database.db";
    options_.camera = {CameraModel::kPinhole, 320, 200, {300, 300, 160, 100}};
    options_.camera_path = "camera.yml";
    options_.layout = MakeLayout("DICT_4X4_50", 0.1);
    options_.num_threads = 2;
  }

  void WritePicture(const std::string& name, int idx, const std::vector<int>& ids,
                    const std::string& dictionary = "DICT_4X4_50") {
    cv::imwrite(dir_ / ("images/" + name), Picture(idx, ids, dictionary));
  }

  // Frames 0, 1, 4, 5, 8, 9 ... hold markers 1 and 2.
  void WriteVideo(int num_frames) {
    options_.image_path = dir_ / "video.avi";
    cv::VideoWriter writer(options_.image_path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           kSize);
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < num_frames; ++i) {
      writer << Picture(i, i % 4 < 2 ? std::vector<int>{1, 2} : std::vector<int>{}, "DICT_4X4_50");
    }
  }

  std::vector<DatabaseImage> ReadImages() const {
    return ColmapDatabase(options_.database_path, ColmapDatabase::Mode::kReadOnly).ReadImages();
  }

  TempDir dir_;
  MarkerImporterOptions options_;
};

TEST_F(MarkerImporterTest, FolderOfImages) {
  WritePicture("2.png", 0, {1, 2});
  WritePicture("10.png", 1, {2, 3});
  WritePicture("11.png", 2, {});
  std::vector<int> done;
  const ImportReport report = ImportMarkers(options_, [&](int n, int total, const std::string&) {
    done.push_back(n);
    EXPECT_EQ(total, 3);
  });
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(report.num_frames_read, 3);
  EXPECT_EQ(report.num_images_added, 3);
  EXPECT_EQ(report.num_images_present, 0);
  EXPECT_EQ(report.num_images_without_markers, 1);
  EXPECT_EQ(report.num_markers, 4);
  EXPECT_EQ(report.num_rejected, 0);
  EXPECT_EQ(report.num_pairs, 1);
  const std::vector<DatabaseImage> images = ReadImages();
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].detections.image_name, "2.png");
  EXPECT_EQ(images[1].detections.image_name, "10.png");
  const MarkerDetection& marker = images[1].detections.markers.at(0);
  EXPECT_EQ(marker.marker_id, 2);
  EXPECT_NEAR(marker.corners_in_image_px[0].x(), 21, 0.1);
  EXPECT_NEAR(marker.corners_in_image_px[0].y(), 42, 0.1);
  EXPECT_EQ(fs::exists(dir_ / "database.db-journal"), false);
}

TEST_F(MarkerImporterTest, FailedCornerFitsAreCountedAndMarked) {
  // Litter covers all but three pixels of the quiet zone of marker 1: its code is read, but neither
  // the marker as a whole nor its sides look as they should.
  cv::Mat picture = Picture(0, {1, 2}, "DICT_4X4_50");
  const cv::Rect outside(2, 22, 108, 108), inside(17, 37, 78, 78);
  const cv::Mat marker = picture(inside).clone();
  cv::Mat litter(outside.size(), CV_8U);
  cv::RNG(1).fill(litter, cv::RNG::UNIFORM, 0, 2);
  litter *= 255;
  cv::cvtColor(litter, litter, cv::COLOR_GRAY2BGR);
  litter.copyTo(picture(outside));
  marker.copyTo(picture(inside));
  cv::imwrite(dir_ / "images/1.png", picture);
  const ImportReport report = ImportMarkers(options_);
  ASSERT_EQ(report.num_markers, 2);
  EXPECT_EQ(report.num_fallbacks, 1);
  const std::vector<DatabaseImage> images = ReadImages();
  const std::vector<MarkerDetection>& markers = images[0].detections.markers;
  EXPECT_TRUE(markers[0].is_fallback);
  EXPECT_FALSE(markers[1].is_fallback);
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    EXPECT_EQ(markers[0].corner_sigma_px[i], 0.0);
    EXPECT_GT(markers[1].corner_sigma_px[i], 0.0);
  }
}

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

TEST_F(MarkerImporterTest, OneMarkerDoesNotTellTheCamera) {
  WritePicture("1.png", 0, {1});
  ImportMarkers(options_);
  const ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadOnly);
  const FormationEstimate formation = database.ReadFormation().value();
  EXPECT_EQ(formation.num_samples, 0);
  EXPECT_EQ(formation.parameters.gamma, 1.0);
  EXPECT_GT(formation.inset_sigma_px, 0.1);
}

TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothing) {
  for (int i = 0; i < 8; ++i) WritePicture(std::to_string(i) + ".png", i, {1, 2, 3});
  options_.num_threads = 1;
  ImportMarkers(options_);
  const auto read = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string bytes = read(options_.database_path);
  fs::remove(options_.database_path);
  options_.num_threads = 4;
  ImportMarkers(options_);
  EXPECT_EQ(read(options_.database_path), bytes);
}

// Markers 5 and 6 are visible in some of the frames only.
TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothingWithAMap) {
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
    EXPECT_EQ(report.prior_shape.num_agreeing, report.prior_shape.num_known);
    EXPECT_GT(report.prior_shape.num_agreeing, 40 * 4);
    std::ifstream stream(options_.database_path, std::ios::binary);
    const std::string now(std::istreambuf_iterator<char>(stream), {});
    if (num_threads == 1) bytes = now;
    EXPECT_EQ(now, bytes) << num_threads;
  }
}

TEST_F(MarkerImporterTest, NumberOfThreadsChangesNothingInATrackedVideo) {
  WriteVideo(40);
  const auto run = [&](int num_threads, SearchMode search) {
    fs::remove(options_.database_path);
    options_.num_threads = num_threads;
    options_.detection.search = search;
    ImportMarkers(options_);
    std::ifstream stream(options_.database_path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
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
                           {options_.database_path, "other detection options"});
  other = options_;
  LayoutPart part;
  part.name = "sail";
  part.marker_ids = {1, 2};
  other.layout.parts = {part};
  ExpectThrows<InputError>([&] { ImportMarkers(other); }, {"another layout"});
  other = options_;
  other.camera->params[0] = 301;
  ExpectThrows<InputError>([&] { ImportMarkers(other); },
                           {options_.database_path, "another calibration", "camera.yml"});
  EXPECT_EQ(ReadImages().size(), 1u);
}

TEST_F(MarkerImporterTest, VideoKeepsFramesWithMarkers) {
  WriteVideo(10);
  options_.frame_output_path = dir_ / "frames";
  const ImportReport report = ImportMarkers(options_);
  EXPECT_EQ(report.num_frames_read, 10);
  EXPECT_EQ(report.num_images_added, 6);
  EXPECT_EQ(report.num_images_without_markers, 4);
  const std::vector<DatabaseImage> images = ReadImages();
  ASSERT_EQ(images.size(), 6u);
  EXPECT_EQ(images[2].detections.frame_number, 4);
  EXPECT_NEAR(images[2].detections.time_s.value(), 0.4, 1e-9);
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_ / "frames"), {}), 6);
  EXPECT_EQ(cv::imread(dir_ / "frames/frame_000004.jpg").size(), kSize);
  for (const ImportStage stage : {ImportStage::kDecode, ImportStage::kDetect, ImportStage::kRefine,
                                  ImportStage::kImages, ImportStage::kDatabase}) {
    EXPECT_GT(report.times[stage].wall_s, 0.0) << ImportStageName(stage);
    EXPECT_GT(report.times[stage].cpu_s, 0.0) << ImportStageName(stage);
  }
  EXPECT_EQ(ImportMarkers(options_).num_images_added, 0);
}

TEST_F(MarkerImporterTest, IdsThatTheLayoutDoesNotNameAreReported) {
  WritePicture("1.png", 0, {1, 2, 7});
  LayoutPart part;
  part.name = "sail";
  part.marker_ids = {1, 2};
  options_.layout.parts = {part};
  const ImportReport report = ImportMarkers(options_);
  EXPECT_THAT(report.ids_not_in_layout, ElementsAre(7));
  EXPECT_EQ(report.num_markers, 2);
  EXPECT_EQ(report.num_rejected, 1);
  const std::vector<DatabaseImage> images = ReadImages();
  EXPECT_EQ(images[0].detections.markers[0].part, "sail");
  EXPECT_EQ(images[0].detections.rejected.at(0).reason, "not in layout");
}

TEST_F(MarkerImporterTest, NoMarkerOfTheLayoutIsADataError) {
  WritePicture("1.png", 0, {1, 7});
  LayoutPart part;
  part.name = "sail";
  part.marker_ids = {30};
  options_.layout.parts = {part};
  ExpectThrows<DataError>([&] { ImportMarkers(options_); }, {"no marker of the layout", "1 7"});
}

TEST_F(MarkerImporterTest, BrokenImagesAreSkippedUnlessAllAre) {
  WritePicture("1.png", 0, {1, 2});
  std::ofstream(dir_ / "images/2.png") << "no picture";
  const ImportReport report = ImportMarkers(options_);
  EXPECT_EQ(report.num_images_added, 1);
  ASSERT_EQ(report.skipped.size(), 1u);
  EXPECT_EQ(report.skipped[0].image_name, "2.png");
  EXPECT_EQ(report.skipped[0].reason, "not an image that can be decoded");
  fs::remove(dir_ / "images/1.png");
  fs::remove(options_.database_path);
  ExpectThrows<InputError>([&] { ImportMarkers(options_); }, {"none of 1 images", "2.png"});
  EXPECT_FALSE(fs::exists(options_.database_path));
}

TEST_F(MarkerImporterTest, HintsAtTheRightDictionary) {
  WritePicture("1.png", 0, {60, 2}, "DICT_6X6_100");
  ExpectThrows<DataError>(
      [&] { ImportMarkers(options_); },
      {"no marker of DICT_4X4_50", "--dictionary DICT_6X6_100", "--ArucoDetection.inverted 0"});
  EXPECT_FALSE(fs::exists(options_.database_path));
}

TEST_F(MarkerImporterTest, HintsAtInvertedMarkers) {
  cv::Mat inverted;
  cv::bitwise_not(Picture(0, {1, 2}, "DICT_4X4_50"), inverted);
  cv::imwrite(dir_ / "images/1.png", inverted);
  ExpectThrows<DataError>([&] { ImportMarkers(options_); },
                          {"--dictionary DICT_4X4_50", "--ArucoDetection.inverted 1"});
  options_.detection.inverted = true;
  EXPECT_EQ(ImportMarkers(options_).num_markers, 2);
}

TEST_F(MarkerImporterTest, AFewFalseMarkersDoNotHideTheRightDictionary) {
  // One marker of the wanted dictionary among eight pictures full of another's.
  for (int i = 0; i < 8; ++i) {
    WritePicture(std::to_string(i) + ".png", i, {60, 2, 5}, "DICT_6X6_100");
  }
  WritePicture("8.png", 0, {1});
  ExpectThrows<DataError>([&] { ImportMarkers(options_); },
                          {"hardly any marker of DICT_4X4_50", "--dictionary DICT_6X6_100"});
  EXPECT_FALSE(fs::exists(options_.database_path));
}

TEST_F(MarkerImporterTest, RareMarkersAreAcceptedWhereNothingElseIsFound) {
  WritePicture("0.png", 0, {1});
  for (int i = 1; i < 5; ++i) WritePicture(std::to_string(i) + ".png", i, {});
  EXPECT_EQ(ImportMarkers(options_).num_markers, 1);
}

TEST_F(MarkerImporterTest, ImageOfAnotherSizeNeedsAPureScale) {
  WritePicture("1.png", 0, {1, 2});
  cv::Mat larger;
  cv::resize(Picture(0, {1, 2}, "DICT_4X4_50"), larger, cv::Size(640, 400));
  cv::imwrite(dir_ / "images/2.png", larger);
  ImportMarkers(options_);
  const auto cameras =
      ColmapDatabase(options_.database_path, ColmapDatabase::Mode::kReadOnly).ReadCameras();
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras.at(2).params, (std::vector<double>{600, 600, 320, 200}));
  cv::imwrite(dir_ / "images/3.png", larger(cv::Rect(0, 0, 300, 300)));
  fs::remove(options_.database_path);
  ExpectThrows<InputError>([&] { ImportMarkers(options_); }, {"camera.yml", "300x300", "3.png"});
  EXPECT_FALSE(fs::exists(options_.database_path));
}

TEST_F(MarkerImporterTest, FailedRunLeavesAnExistingDatabaseAlone) {
  WritePicture("1.png", 0, {1, 2});
  ImportMarkers(options_);
  options_.image_path = dir_ / "none";
  EXPECT_THROW(ImportMarkers(options_), InputError);
  EXPECT_EQ(ReadImages().size(), 1u);
}

}  // namespace
}  // namespace velamap
