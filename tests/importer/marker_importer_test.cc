#include "importer/marker_importer.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/importer/marker_importer_fixture.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST_F(MarkerImporterTest, FolderOfImages) {
  WritePicture("2.png", 0, {1, 2});
  WritePicture("10.png", 1, {2, 3});
  WritePicture("11.png", 2, {});
  std::vector<int> done;
  const auto count = [&](int n, int total, const std::string&) {
    done.push_back(n);
    EXPECT_EQ(total, 3);
  };
  std::mutex mutex;
  std::map<int, int> calls_by_total;
  const auto count_formation = [&](int, int total, const std::string&) {
    const std::lock_guard<std::mutex> lock(mutex);
    ++calls_by_total[total];
  };
  const ImportReport report = ImportMarkers(options_, {count_formation, count_formation, count});
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3));
  // The estimate of camera and print looks at all pictures, and then fits some of their markers.
  ASSERT_EQ(calls_by_total.size(), 2u);
  EXPECT_EQ(calls_by_total[3], 4);
  const auto [num_expected, num_calls] = *calls_by_total.rbegin();
  EXPECT_GT(num_calls, num_expected / 4);
  EXPECT_LT(num_calls, 4 * num_expected);
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

TEST_F(MarkerImporterTest, OneMarkerDoesNotTellTheCamera) {
  WritePicture("1.png", 0, {1});
  ImportMarkers(options_);
  const ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadOnly);
  const FormationEstimate formation = database.ReadFormation().value();
  EXPECT_EQ(formation.num_samples, 0);
  EXPECT_EQ(formation.parameters.gamma, 1.0);
  EXPECT_GT(formation.inset_sigma_px, 0.1);
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
  for (const ImportStage stage :
       {ImportStage::kFormation, ImportStage::kDecode, ImportStage::kDetect, ImportStage::kRefine,
        ImportStage::kImages, ImportStage::kDatabase}) {
    EXPECT_GT(report.times[stage].wall_s, 0.0) << ImportStageName(stage);
    EXPECT_GT(report.times[stage].cpu_s, 0.0) << ImportStageName(stage);
  }
  const ImportReport again = ImportMarkers(options_);
  EXPECT_EQ(again.num_images_added, 0);
  EXPECT_EQ(again.times[ImportStage::kFormation].cpu_s, 0.0) << "the estimate is in the database";
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

TEST_F(MarkerImporterTest, RejectedMarkersAreAllExplained) {
  // Marker 1 is of the layout but twice in the picture, with no neighbour; marker 7 is not.
  WritePicture("1.png", 0, {1, 1, 7});
  ExpectThrows<DataError>(
      [&] {
        MarkerImporterOptions options = options_;
        LayoutPart part;
        part.name = "sail";
        part.marker_ids = {1, 2};
        options.layout.parts = {part};
        ImportMarkers(options);
      },
      {"2 because their id occurs more than once", "neighbours in the layout",
       "1 because the layout does not name their ids: 7"});
  WritePicture("1.png", 0, {1, 1});
  ExpectThrows<DataError>([&] { ImportMarkers(options_); },
                          {"2 because their id occurs more than once", "--layout_path"});
}

TEST_F(MarkerImporterTest, SymmetricMarkersAloneAreNotTakenForDuplicates) {
  // The last codes of the thesis look the same after half a turn.
  WritePicture("1.png", 0, {125}, "THESIS_3X3_130");
  options_.layout = MakeLayout("THESIS_3X3_130", 0.1);
  ExpectThrows<DataError>([&] { ImportMarkers(options_); },
                          {"1 because their code looks the same when turned"});
}

TEST_F(MarkerImporterTest, WarnsOfSymmetricMarkersThatAreSeen) {
  options_.layout = MakeLayout("THESIS_3X3_130", 0.1);
  const auto log_of = [&](int marker_id) {
    WritePicture("1.png", 0, {1, marker_id}, "THESIS_3X3_130");
    WritePicture("2.png", 1, {1, marker_id}, "THESIS_3X3_130");
    fs::remove(options_.database_path);
    testing::internal::CaptureStdout();
    ImportMarkers(options_);
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(log_of(125), HasSubstr("look the same when turned: 125; "));
  EXPECT_THAT(log_of(2), Not(HasSubstr("look the same")));
}

TEST_F(MarkerImporterTest, BrokenImagesAreSkippedUnlessAllAre) {
  WritePicture("1.png", 0, {1, 2});
  std::ofstream(dir_ / "images/2.png") << "no picture";
  fs::create_symlink("deleted.png", dir_ / "images/3.png");
  fs::create_symlink("4.png", dir_ / "images/4.png");
  const ImportReport report = ImportMarkers(options_);
  EXPECT_EQ(report.num_images_added, 1);
  ASSERT_EQ(report.skipped.size(), 3u);
  EXPECT_EQ(report.skipped[0].image_name, "2.png");
  EXPECT_EQ(report.skipped[0].reason, "not an image that can be decoded");
  EXPECT_EQ(report.skipped[1].image_name, "3.png");
  EXPECT_EQ(report.skipped[1].reason, "cannot be read");
  EXPECT_EQ(report.skipped[2].image_name, "4.png");
  fs::remove(dir_ / "images/1.png");
  fs::remove(options_.database_path);
  ExpectThrows<InputError>([&] { ImportMarkers(options_); }, {"none of 3 images", "2.png"});
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

TEST_F(MarkerImporterTest, PixelsThatAreNotSquareNeedACalibration) {
  options_.image_path = dir_ / "wide.mp4";
  const std::string command =
      "ffmpeg -loglevel error -y -f lavfi -i testsrc2=size=320x200 -frames:v 3 -vf setsar=4/3 "
      "-c:v libx264 '" +
      options_.image_path + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  ExpectThrows<DataError>([&] { ImportMarkers(options_); },
                          {"no marker"});  // with the camera's calibration
  options_.camera.reset();
  ExpectThrows<InputError>([&] { ImportMarkers(options_); },
                           {"wide.mp4", "1.333 times", "setsar=1"});
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

TEST_F(MarkerImporterTest, ACalibrationOfAnotherSizeIsRefusedBeforeTheEstimateOfCameraAndPrint) {
  WritePicture("1.png", 0, {1, 2});
  options_.camera->height_px = 320;
  int num_calls = 0;
  const auto count = [&](int, int, const std::string&) { ++num_calls; };
  ExpectThrows<InputError>(
      [&] {
        ImportMarkers(options_, {count, count, count});
      },
      {"camera.yml", "320x200", "1.png"});
  EXPECT_EQ(num_calls, 0);
}

TEST_F(MarkerImporterTest, MakesTheFolderOfTheDatabase) {
  WritePicture("1.png", 0, {1, 2});
  options_.database_path = dir_ / "work/a/database.db";
  EXPECT_EQ(ImportMarkers(options_).num_images_added, 1);
  EXPECT_TRUE(fs::is_regular_file(options_.database_path));
}

}  // namespace
}  // namespace velamap
