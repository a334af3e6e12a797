#include "importer/database_merger.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/dictionary.h"
#include "importer/marker_importer.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/database_text.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

const cv::Size kPictureSize(320, 200);
constexpr int kInterval = 1, kGroup = 120 * kInterval;  // FramesPerGroup()

// A video of some groups of frames, imported as a whole and in parts.
class DatabaseMergerTest : public testing::Test {
 protected:
  DatabaseMergerTest() {
    importer_.image_path = dir_ / "video.avi";
    importer_.camera = {CameraModel::kPinhole, 320, 200, {300, 300, 160, 100}};
    importer_.camera_path = "camera.yml";
    importer_.layout = MakeLayout("DICT_4X4_50", 0.1);
    importer_.detection.full_search_interval = kInterval;
    importer_.detection.estimate_formation = false;
    importer_.num_threads = 2;
  }

  // Markers that swing; `draw` adds to the picture what it likes.
  template <typename MarkersOf, typename Draw>
  void WriteVideo(int num_frames, const MarkersOf& markers_of, const Draw& draw) {
    cv::VideoWriter writer(importer_.image_path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           kPictureSize);
    ASSERT_TRUE(writer.isOpened());
    const auto dictionary = LoadDictionary(importer_.layout.dictionary).aruco;
    for (int i = 0; i < num_frames; ++i) {
      cv::Mat picture = DrawMarkers(dictionary, kPictureSize, markers_of(i));
      draw(i, &picture);
      cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
      writer << picture;
    }
  }

  static int Swing(int frame) { return 15 - std::abs(frame % 30 - 15); }

  // Two markers. A rope crosses the second one all the time but for the beginning, so that only
  // tracks of earlier frames find it; in some frames there is nothing.
  void WriteVideoWithRope(int num_frames) {
    const auto markers_of = [](int i) {
      if (i % 25 > 22) return std::vector<DrawnMarker>{};
      return std::vector<DrawnMarker>{{1, 20 + Swing(i), 40, 72}, {2, 115 + Swing(i), 45, 72}};
    };
    WriteVideo(num_frames, markers_of, [](int i, cv::Mat* picture) {
      const int x = 151 + Swing(i);
      if (i > 5) cv::line(*picture, {x, 0}, {x, kPictureSize.height}, cv::Scalar::all(0), 4);
    });
  }

  std::string Import(std::optional<VideoPart> part) {
    importer_.part = part;
    importer_.database_path =
        dir_ / (part ? fmt::format("part{}of{}.db", part->number, part->count) : "whole.db");
    ImportMarkers(importer_);
    return importer_.database_path;
  }

  std::vector<std::string> ImportParts(int count) {
    std::vector<std::string> paths;
    for (int number = count; number >= 1; --number) {  // in another order than that of time
      paths.push_back(Import(VideoPart{number, count}));
    }
    return paths;
  }

  MergeReport Merge(const std::vector<std::string>& paths) const {
    return MergeDatabases({paths, dir_ / "merged.db", importer_.layout});
  }

  void ExpectRefusal(const std::vector<std::string>& paths,
                     std::initializer_list<std::string> words) const {
    ExpectThrows<InputError>([&] { Merge(paths); }, words);
    EXPECT_FALSE(fs::exists(dir_ / "merged.db"));
  }

  TempDir dir_;
  MarkerImporterOptions importer_;
};

TEST_F(DatabaseMergerTest, PartsHaveTheRowsOfOneImport) {
  constexpr int kTrackedInterval = 2, kTrackedGroup = 120 * kTrackedInterval;
  importer_.detection.full_search_interval = kTrackedInterval;
  WriteVideoWithRope(2 * kTrackedGroup + 7);
  const std::string whole = DatabaseText(Import(std::nullopt));
  for (const int count : {2, 3}) {  // the video has two groups
    const MergeReport report = Merge(ImportParts(count));
    EXPECT_TRUE(DatabaseText(dir_ / "merged.db") == whole) << count;
    EXPECT_GT(report.num_images, kTrackedGroup);
    EXPECT_GT(report.num_markers, report.num_images);
    EXPECT_GT(report.num_pairs, report.num_images);
  }
  // A later import finds nothing that has not been searched.
  importer_.part.reset();
  importer_.database_path = dir_ / "merged.db";
  EXPECT_EQ(ImportMarkers(importer_).num_frames_read, 0);
  EXPECT_TRUE(DatabaseText(dir_ / "merged.db") == whole);
}

TEST_F(DatabaseMergerTest, TheImageFormationIsThatOfTheWholeVideo) {
  importer_.detection.estimate_formation = true;
  // The estimate looks at frames 0, 5 ... 35, then 36, 46 ..., then 107, 127 ... To save time, only
  // two of these show markers. The second part is blurred.
  WriteVideo(
      2 * kGroup,
      [](int i) {
        if (i % 5 < 3 && i % 30 > 0) return std::vector<DrawnMarker>{};
        return std::vector<DrawnMarker>{{1, 20, 40, 48}, {2, 115, 45, 48}};
      },
      [](int i, cv::Mat* picture) {
        if (i >= kGroup) cv::GaussianBlur(*picture, *picture, cv::Size(), 1.0);
      });
  const auto formation_of = [](const std::string& path) {
    return ColmapDatabase(path, ColmapDatabase::Mode::kReadOnly).ReadFormation().value();
  };
  const FormationEstimate whole = formation_of(Import(std::nullopt));
  const FormationEstimate second = formation_of(Import(VideoPart{2, 2}));
  EXPECT_GT(whole.num_samples, 0);
  EXPECT_EQ(second.num_samples, whole.num_samples);
  EXPECT_EQ(second.noise_gray, whole.noise_gray);
  EXPECT_EQ(second.parameters.sharpening, whole.parameters.sharpening);
}

TEST_F(DatabaseMergerTest, APartMayBeWithoutMarkers) {
  WriteVideo(
      3 * kGroup,
      [](int i) {
        if (i >= kGroup && i < 2 * kGroup) return std::vector<DrawnMarker>{};
        return std::vector<DrawnMarker>{{1, 20 + Swing(i), 40, 72}};
      },
      [](int, cv::Mat*) {});
  const std::string whole = DatabaseText(Import(std::nullopt));
  Merge(ImportParts(3));
  EXPECT_TRUE(DatabaseText(dir_ / "merged.db") == whole);
  ColmapDatabase middle(dir_ / "part2of3.db", ColmapDatabase::Mode::kReadOnly);
  EXPECT_TRUE(middle.ReadImageIdsByName().empty());
}

// Marker 2 looks the same upside down; only the frames of the second part, which show marker 0,
// tell how it is turned in the first (OtherFramesTellTheRotationOfASymmetricMarker).
TEST_F(DatabaseMergerTest, PartsTellEachOtherTheRotationOfASymmetricMarker) {
  std::ofstream(dir_ / "nine_bits.yml") << "%YAML:1.0\n---\nnmarkers: 3\nmarkersize: 3\n"
                                           "maxCorrectionBits: 0\nmarker_0: \"110100001\"\n"
                                           "marker_1: \"111000100\"\nmarker_2: \"100000001\"\n";
  importer_.layout = MakeLayout(dir_ / "nine_bits.yml", 0.1);
  WriteVideo(
      2 * kGroup,
      [](int i) {
        const int x = Swing(i);
        std::vector<DrawnMarker> markers = {{1, 115 + x, 40, 70}, {2, 210 + x, 40 + x, 70}};
        if (i >= kGroup) markers.push_back({0, 20 + x, 40, 70});
        return markers;
      },
      [](int i, cv::Mat* picture) {
        const cv::Mat across = (*picture)(cv::Rect(115 + Swing(i), 40, 70, 70));
        cv::Mat turned;
        cv::rotate(across, turned, cv::ROTATE_90_CLOCKWISE);
        turned.copyTo(across);
      });
  const std::string whole = DatabaseText(Import(std::nullopt));
  EXPECT_EQ(Merge(ImportParts(2)).num_markers, 5 * kGroup);
  EXPECT_TRUE(DatabaseText(dir_ / "merged.db") == whole);
}

TEST_F(DatabaseMergerTest, RefusesWhatIsNotEveryPartOnce) {
  WriteVideoWithRope(4);
  const std::string whole = Import(std::nullopt);
  const std::vector<std::string> two = ImportParts(2), three = ImportParts(3);
  ExpectRefusal({}, {"--database_paths"});
  ExpectRefusal({two[0], whole}, {whole, "holds no part of a video"});
  ExpectRefusal({two[0]}, {"part 1/2 is missing", "--video_part 1/2"});
  ExpectRefusal({three[2], three[0]}, {"part 2/3 is missing"});
  ExpectRefusal({two[0], two[1], two[0]}, {two[0], "holds part 2/2", "name each part once"});
  ExpectRefusal({two[1], three[1]}, {three[1], "does not match", two[1], "different splits"});
  SQLite::Database(two[1], SQLite::OPEN_READWRITE).exec("UPDATE marker_part SET is_finished = 0");
  ExpectRefusal(two, {two[1], "part 1/2 has not finished"});
}

TEST_F(DatabaseMergerTest, RefusesPartsThatWereChanged) {
  WriteVideoWithRope(4);
  const std::string first = Import(VideoPart{1, 2}), second = dir_ / "second.db";
  fs::copy(first, second);
  SQLite::Database sqlite(second, SQLite::OPEN_READWRITE);
  sqlite.exec("UPDATE marker_part SET part = 2");
  ExpectRefusal({first, second}, {second, "frame_000000.jpg is also in an earlier part"});
  sqlite.exec("UPDATE images SET camera_id = 9");
  ExpectRefusal({first, second}, {second, "frame_000000.jpg names camera 9"});
}

TEST_F(DatabaseMergerTest, RefusesPartsOfDifferentImports) {
  WriteVideoWithRope(2 * kGroup);
  const std::vector<std::string> parts = ImportParts(2);
  const auto expect = [&](const std::string& change, const std::string& word) {
    SCOPED_TRACE(change);
    const std::string other = dir_ / "other.db";
    fs::copy(parts[0], other, fs::copy_options::overwrite_existing);
    SQLite::Database(other, SQLite::OPEN_READWRITE).exec(change);
    ExpectRefusal({other, parts[1]}, {other, "does not match", parts[1], word});
  };
  expect("UPDATE marker_part SET detector = 'another'", "other detection options");
  expect("UPDATE marker_part SET frame_step = 2", "the frames of the whole import");
  expect("UPDATE marker_sources SET content_hash = 1", "another video");
  expect("UPDATE cameras SET width = 321", "another camera");
  expect("UPDATE cameras SET prior_focal_length = 0", "another camera");
  {
    ColmapDatabase database(parts[1], ColmapDatabase::Mode::kReadWriteCreate);
    database.WriteFormation({});
  }
  expect("DROP TABLE IF EXISTS image_formation", "table image_formation");
}

TEST_F(DatabaseMergerTest, RefusesAnotherLayoutAndTheDatabaseOfOthers) {
  WriteVideoWithRope(4);
  const std::vector<std::string> parts = ImportParts(1);
  DatabaseMergerOptions other{parts, dir_ / "merged.db", MakeLayout("DICT_4X4_100", 0.1)};
  ExpectThrows<InputError>([&] { MergeDatabases(other); }, {"--layout_path", parts[0]});
  SQLite::Database(dir_ / "merged.db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE notes(text TEXT)");
  ExpectThrows<InputError>([&] { Merge(parts); }, {"merged.db", "another program"});
  fs::remove(dir_ / "merged.db");
  for (int i = 0; i < 2; ++i) Merge(parts);  // one of velamap is replaced
  EXPECT_FALSE(fs::exists(dir_ / ".merged.db.lock"));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), {}), 3);
}

TEST_F(DatabaseMergerTest, NoMarkerInAnyPartIsADataError) {
  WriteVideo(
      4, [](int) { return std::vector<DrawnMarker>{}; }, [](int, cv::Mat*) {});
  const std::vector<std::string> parts = ImportParts(2);
  ExpectThrows<DataError>([&] { Merge(parts); }, {"no part of the video holds a marker"});
}

}  // namespace
}  // namespace velamap
