// Folders of drawn pictures and videos, for the tests of the whole import.

#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "importer/database/colmap_database.h"
#include "importer/layout/dictionary.h"
#include "importer/marker_importer.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/temp_dir.h"

namespace velamap {

namespace fs = std::filesystem;

inline const cv::Size kSize(320, 200);

// Draws markers that move by a pixel or two from picture to picture.
inline cv::Mat Picture(int idx, const std::vector<int>& ids, const std::string& dictionary) {
  std::vector<DrawnMarker> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    markers.push_back({ids[i], 20 + 95 * static_cast<int>(i) + idx, 40 + 2 * idx, 72});
  }
  cv::Mat picture = DrawMarkers(LoadDictionary(dictionary).aruco, kSize, markers);
  cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
  picture.convertTo(picture, -1, 0.8, 20);  // clips neither black nor white
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

  std::string DatabaseBytes() const {
    std::ifstream stream(options_.database_path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }

  TempDir dir_;
  MarkerImporterOptions options_;
};

}  // namespace velamap
