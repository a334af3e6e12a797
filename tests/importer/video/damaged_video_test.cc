// Frames that the decoder has patched up are told from whole ones, whatever the number of threads.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "importer/video/frame_source.h"
#include "importer/video/video_decoder.h"
#include "tests/importer/video/grey_clip.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

constexpr int kKeyDistance = 12;

struct SpoiltClip {
  const char* file_name;
  const char* encoding;  // options of ffmpeg
};

std::string SpoiltBytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

void WriteSpoilt(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void EncodeClip(const std::string& path, const std::string& encoding) {
  MakeGreyClip(path, fmt::format("-g {} {}", kKeyDistance, encoding));
}

struct DecodedFrame {
  bool is_whole = true;
  cv::Mat gray;
};

// By ms since the beginning: where a frame is lost, the numbers of later ones are others.
std::map<long, DecodedFrame> DecodeAll(const std::string& path, int num_threads) {
  VideoDecoder decoder(path, num_threads);
  std::map<long, DecodedFrame> frames;
  while (std::optional<VideoFrame> frame = decoder.Next()) {
    frames[std::lround(1000 * frame->time_s.value())] = {frame->is_whole, frame->picture.Gray()};
  }
  return frames;
}

class DamagedVideoTest : public testing::TestWithParam<SpoiltClip> {
 protected:
  void SetUp() override { EncodeClip(path_, GetParam().encoding); }

  TempDir dir_;
  std::string path_ = dir_ / GetParam().file_name;
};

TEST_P(DamagedVideoTest, WholeFramesAreThoseOfTheUndamagedFile) {
  const std::map<long, DecodedFrame> good = DecodeAll(path_, 2);
  EXPECT_EQ(good.size(), static_cast<std::size_t>(kNumClipFrames));
  for (const auto& [time_ms, frame] : good) EXPECT_TRUE(frame.is_whole) << time_ms;
  std::string bytes = SpoiltBytes(path_);
  for (std::size_t i = 0; i < 400; ++i) bytes[bytes.size() * 2 / 5 + i] ^= 0x5a;
  WriteSpoilt(path_, bytes);
  std::map<long, bool> expected;
  for (const int num_threads : {1, 2, 5}) {
    const std::map<long, DecodedFrame> frames = DecodeAll(path_, num_threads);
    std::map<long, bool> is_whole;
    for (const auto& [time_ms, frame] : frames) {
      is_whole[time_ms] = frame.is_whole;
      if (!frame.is_whole) continue;
      ASSERT_EQ(good.count(time_ms), 1u) << time_ms;
      EXPECT_EQ(cv::norm(frame.gray, good.at(time_ms).gray, cv::NORM_INF), 0.0) << time_ms;
    }
    const auto num_whole = std::count_if(is_whole.begin(), is_whole.end(),
                                         [](const auto& frame) { return frame.second; });
    EXPECT_LT(num_whole, kNumClipFrames);
    EXPECT_GE(num_whole, kNumClipFrames - 2 * kKeyDistance) << "the next key frame ends the damage";
    if (num_threads == 1) expected = is_whole;
    EXPECT_EQ(is_whole, expected) << num_threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Clips, DamagedVideoTest,
                         testing::Values(SpoiltClip{"h264.mp4", "-c:v libx264 -bf 3 -crf 10"},
                                         SpoiltClip{"h264.mkv", "-c:v libx264 -bf 3 -crf 10"},
                                         SpoiltClip{
                                             "open_groups.ts",
                                             "-c:v libx264 -bf 3 -crf 10 -x264-params open-gop=1"},
                                         SpoiltClip{"with_checksums.mp4",
                                                    "-c:v libx265 -crf 10 -x265-params "
                                                    "log-level=none:keyint=12:bframes=3:hash=1"}),
                         ClipName<SpoiltClip>);

TEST(DamagedVideo, FramesAreReadAndNotUsed) {
  const TempDir dir;
  const std::string path = dir / "clip.mp4";
  ASSERT_NO_FATAL_FAILURE(EncodeClip(path, "-c:v libx264 -bf 3 -crf 10"));
  std::string bytes = SpoiltBytes(path);
  for (std::size_t i = 0; i < 400; ++i) bytes[bytes.size() * 2 / 5 + i] ^= 0x5a;
  WriteSpoilt(path, bytes);
  const auto source = OpenFrameSource(path, {});
  int num_left_out = 0, num_loaded = 0;
  while (std::optional<Frame> frame = source->Next()) {
    std::string reason;
    const bool is_loaded = source->Load(&*frame, &reason);
    EXPECT_EQ(is_loaded, frame->is_whole) << reason;
    ++(is_loaded ? num_loaded : num_left_out);
  }
  EXPECT_GE(num_left_out, 1);
  EXPECT_GE(num_loaded, 75 - 24);
}

// The last packet is cut, and those before it are good.
TEST(DamagedVideo, ATruncatedOneIsUsedToItsEnd) {
  const TempDir dir;
  const std::string path = dir / "clip.mp4";
  ASSERT_NO_FATAL_FAILURE(EncodeClip(path, "-c:v libx264 -bf 0 -movflags +faststart"));
  const std::string bytes = SpoiltBytes(path);
  WriteSpoilt(path, bytes.substr(0, bytes.size() * 2 / 3));
  const std::map<long, DecodedFrame> frames = DecodeAll(path, 2);
  EXPECT_GE(frames.size(), 30u);
  EXPECT_LT(frames.size(), 75u);
  const auto num_left_out = std::count_if(frames.begin(), frames.end(),
                                          [](const auto& frame) { return !frame.second.is_whole; });
  EXPECT_LE(num_left_out, 1);
}

}  // namespace
}  // namespace velamap
