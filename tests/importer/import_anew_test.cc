// An import that replaces an earlier one does so as a whole or not at all.

#include "importer/import_anew.h"

#include <filesystem>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/dictionary.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/database_text.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string BytesOfResult(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

class ImportAnewTest : public testing::Test {
 protected:
  ImportAnewTest() {
    fs::create_directory(dir_ / "result");
    options_.database_path = dir_ / "result/database.db";
    options_.frame_output_path = dir_ / "result/frames";
    options_.layout = MakeLayout("DICT_4X4_50", 0.1);
    options_.detection.estimate_formation = false;
    options_.num_threads = 2;
  }

  // Frames with markers 1 and 2, or 1 and 3, or none.
  void WriteVideo(const std::string& name, int num_frames, const std::vector<int>& ids) {
    options_.image_path = dir_ / name;
    const cv::Size size(320, 200);
    cv::VideoWriter writer(options_.image_path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           size);
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < num_frames; ++i) {
      std::vector<DrawnMarker> markers;
      for (const int id : ids) markers.push_back({id, 20 + 80 * (id - 1) + i, 40, 72});
      cv::Mat picture = DrawMarkers(LoadDictionary("DICT_4X4_50").aruco, size, markers);
      cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
      writer << picture;
    }
  }

  // All files of the result; databases as text.
  std::map<std::string, std::string> Result() const {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(dir_ / "result")) {
      const std::string name = entry.path().lexically_relative(dir_ / "result");
      result[name] = entry.is_directory()    ? "folder"
                     : name == "database.db" ? DatabaseText(entry.path())
                                             : BytesOfResult(entry.path());
    }
    return result;
  }

  TempDir dir_;
  MarkerImporterOptions options_;
};

TEST_F(ImportAnewTest, ThatFailsLeavesTheEarlierImport) {
  WriteVideo("one.avi", 4, {1, 2});
  ImportMarkers(options_);
  const auto earlier = Result();
  EXPECT_EQ(earlier.size(), 6u);  // the database, the folder, and its frames
  options_.import_anew = true;
  WriteVideo("empty.avi", 4, {});
  ExpectThrows<DataError>([&] { ImportMarkers(options_); }, {"empty.avi", "no marker"});
  EXPECT_TRUE(Result() == earlier);
  WriteVideo("other.avi", 4, {1, 3});
  const auto fail = [](int done, int, const std::string&) {
    if (done == 3) throw std::bad_alloc();
  };
  EXPECT_THROW(ImportMarkers(options_, {{}, {}, fail}), std::bad_alloc);
  EXPECT_TRUE(Result() == earlier);
}

TEST_F(ImportAnewTest, ReplacesDatabaseAndFrames) {
  WriteVideo("one.avi", 4, {1, 2});
  ImportMarkers(options_);
  WriteVideo("other.avi", 2, {1, 3});
  options_.import_anew = true;
  EXPECT_EQ(ImportMarkers(options_).num_images_added, 2);
  const auto replaced = Result();
  EXPECT_EQ(replaced.size(), 4u);
  fs::remove_all(dir_ / "result");
  fs::create_directory(dir_ / "result");
  ImportMarkers(options_);
  EXPECT_TRUE(Result() == replaced);
}

// A link stays one, and so does what another program has left of the earlier database.
TEST_F(ImportAnewTest, FollowsALinkAndLeavesNoJournal) {
  WriteVideo("one.avi", 2, {1, 2});
  ImportMarkers(options_);
  fs::create_directory(dir_ / "elsewhere");
  fs::rename(options_.database_path, dir_ / "elsewhere/there.db");
  fs::create_symlink(dir_ / "elsewhere/there.db", options_.database_path);
  std::ofstream(dir_ / "elsewhere/there.db-journal") << std::string(28, '\0');
  WriteVideo("other.avi", 1, {1, 3});
  options_.import_anew = true;
  ImportMarkers(options_);
  EXPECT_TRUE(fs::is_symlink(options_.database_path));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_ / "elsewhere"), {}), 1);
  const ColmapDatabase database(options_.database_path, ColmapDatabase::Mode::kReadOnly);
  EXPECT_EQ(database.ReadImages().size(), 1u);
}

// A run that was killed before or after the new database took the place of the earlier one.
TEST_F(ImportAnewTest, ThatWasKilledIsSettledByTheNextImport) {
  WriteVideo("one.avi", 2, {1, 3});
  ImportMarkers(options_);
  const auto whole = Result();
  const fs::path stage = dir_ / "result/.database.db.velamap-anew";
  const std::string name = "frame_000001.jpg";
  const std::string frame = BytesOfResult(dir_ / "result/frames" / name);
  const auto stage_frame = [&] {
    fs::create_directories(stage / "frames");
    std::ofstream(stage / "frames" / name, std::ios::binary) << frame;
  };
  const auto record = [&] {
    std::ofstream(stage / "replacement", std::ios::binary) << "frames" << '\0';
  };
  stage_frame();
  std::ofstream(stage / "database.db") << "unfinished";
  ImportMarkers(options_);
  EXPECT_TRUE(Result() == whole);
  stage_frame();
  record();
  std::ofstream(stage / "database.db") << "finished";
  ImportMarkers(options_);
  EXPECT_TRUE(Result() == whole);
  stage_frame();
  record();
  fs::remove(dir_ / "result/frames" / name);
  ImportMarkers(options_);
  EXPECT_TRUE(Result() == whole);
  // A picture of the user is not replaced.
  stage_frame();
  record();
  std::ofstream(dir_ / "result/frames" / name) << "of the user";
  ImportMarkers(options_);
  EXPECT_EQ(BytesOfResult(dir_ / "result/frames" / name), "of the user");
  EXPECT_FALSE(fs::exists(stage));
}

}  // namespace
}  // namespace velamap
