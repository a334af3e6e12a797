#include "importer/import_part.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

constexpr int kGroup = 10;

// The numbers of the frames that a video of `num_in_video` frames has.
std::vector<int> FramesOf(const VideoOptions& video, int num_in_video) {
  std::vector<int> frames;
  for (int number = 0; number < num_in_video; ++number) {
    if (video.Selects(number)) frames.push_back(number);
  }
  return frames;
}

// Whatever the video, the parts are its frames in order, and each begins with a group.
TEST(FramesOfPart, PartsAreTheWhole) {
  for (const int num_in_video : {1, 9, 10, 25, 99, 100, 203}) {
    for (const VideoOptions& whole :
         {VideoOptions{}, VideoOptions{4, -1, 1}, VideoOptions{0, 87, 3}, VideoOptions{7, -1, 2}}) {
      const std::vector<int> expected = FramesOf(whole, num_in_video);
      const int num_frames = static_cast<int>(expected.size());
      for (const int count : {1, 2, 3, 7, 40}) {
        std::vector<int> frames;
        for (int number = 1; number <= count; ++number) {
          const auto part = FramesOfPart({number, count}, whole, num_frames, kGroup);
          if (!part) continue;
          EXPECT_EQ(frames.size() % kGroup, 0u);
          const std::vector<int> some = FramesOf(*part, num_in_video);
          EXPECT_EQ(some.empty(), num_frames == 0);
          frames.insert(frames.end(), some.begin(), some.end());
        }
        EXPECT_EQ(frames, expected) << num_in_video << ' ' << whole.first_frame << ' ' << count;
      }
    }
  }
}

// Containers are off by a frame or so.
TEST(FramesOfPart, AWrongNumberOfFramesLosesNone) {
  for (const int num_stated : {97, 99, 101, 103}) {
    std::vector<int> frames;
    for (int number = 1; number <= 4; ++number) {
      const auto part = FramesOfPart({number, 4}, {}, num_stated, kGroup);
      ASSERT_TRUE(part);
      for (const int frame : FramesOf(*part, 100)) frames.push_back(frame);
    }
    EXPECT_EQ(frames, FramesOf({}, 100)) << num_stated;
  }
}

TEST(FramesOfPart, PartsAreOfAboutOneLength) {
  for (int number = 1; number <= 4; ++number) {
    const std::size_t size =
        FramesOf(FramesOfPart({number, 4}, {}, 205, kGroup).value(), 205).size();
    EXPECT_GE(size, 50u);
    EXPECT_LE(size, 65u);
  }
}

TEST(FramesToSearch, PhotographsHaveNoParts) {
  const TempDir dir;
  MarkerImporterOptions options;
  options.image_path = dir.path();
  options.part = VideoPart{1, 2};
  ExpectThrows<InputError>([&] { FramesToSearch(options); },
                           {dir.path().string(), "photographs have no parts", "--video_part 1/2"});
}

TEST(CheckPart, ADatabaseHoldsOnePart) {
  const TempDir dir;
  MarkerImporterOptions options;
  options.database_path = dir / "database.db";
  options.part = VideoPart{2, 3};
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWriteCreate);
  RecordPart(options, "detector", true, &database);
  EXPECT_NO_THROW(CheckPart(options, database));
  const auto expect = [&](const std::optional<VideoPart>& part, const VideoOptions& video,
                          const std::string& word) {
    MarkerImporterOptions other = options;
    other.part = part;
    other.video = video;
    ExpectThrows<InputError>([&] { CheckPart(other, database); },
                             {options.database_path, "holds part 2/3", word, "--import_anew 1"});
  };
  expect(std::nullopt, {}, "velamap database_merger");
  expect(VideoPart{1, 3}, {}, "velamap database_merger");
  expect(VideoPart{2, 3}, {10, -1, 2}, "this run is of frames 10 to the end in steps of 2");
}

}  // namespace
}  // namespace velamap
