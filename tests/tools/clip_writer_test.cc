// Videos of both codecs and ranges hold the grey values that were written.

#include "tests/support/clip/clip_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/video/frame_source.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;

constexpr int kTilePx = 32, kTilesInRow = 16;

// Tiles of the grey values 0 to 255.
cv::Mat GreyTiles() {
  cv::Mat image(kTilePx * kTilesInRow, kTilePx * kTilesInRow, CV_8UC3);
  for (int gray = 0; gray < 256; ++gray) {
    const cv::Rect tile(kTilePx * (gray % kTilesInRow), kTilePx * (gray / kTilesInRow), kTilePx,
                        kTilePx);
    image(tile).setTo(cv::Scalar::all(gray));
  }
  return image;
}

struct VideoCase {
  ClipCodec codec;
  bool full_range;
  const char *codec_name, *range_name;  // as ffprobe calls them
};

class ClipWriterTest : public ::testing::TestWithParam<VideoCase> {};

TEST_P(ClipWriterTest, VideoHoldsTheGreyValues) {
  TempDir dir;
  ClipWriterOptions options;
  options.codec = GetParam().codec;
  options.full_range = GetParam().full_range;
  options.crf = 4;
  ClipWriter writer(dir.path(), options);
  for (int i = 0; i < 2; ++i) writer.Write(GreyTiles());
  writer.Finish();

  const ProgramRun probe = RunProgram(
      "/usr/bin/env", {"ffprobe", "-v", "error", "-select_streams", "v", "-show_entries",
                       "stream=codec_name,color_range", "-of", "default", writer.path().string()});
  ASSERT_EQ(probe.exit_code, 0) << probe.err;
  EXPECT_THAT(probe.out, HasSubstr(std::string("codec_name=") + GetParam().codec_name));
  EXPECT_THAT(probe.out, HasSubstr(std::string("color_range=") + GetParam().range_name));

  const auto frames = OpenFrameSource(writer.path().string(), {});
  std::optional<Frame> frame = frames->Next();
  std::string reason;
  ASSERT_TRUE(frame);
  ASSERT_TRUE(frames->Load(&*frame, &reason)) << reason;
  // Steps of limited range are 1.16 wide, and the conversions to it and back round down.
  const double tolerance = GetParam().full_range ? 1.0 : 2.2;
  for (int gray = 0; gray < 256; ++gray) {
    // Their middles, because codecs smooth at the borders.
    const cv::Rect middle(kTilePx * (gray % kTilesInRow) + 8, kTilePx * (gray / kTilesInRow) + 8,
                          16, 16);
    EXPECT_NEAR(cv::mean(frame->gray(middle))[0], gray, tolerance) << gray;
  }
}

INSTANTIATE_TEST_SUITE_P(AllVideos, ClipWriterTest,
                         ::testing::Values(VideoCase{ClipCodec::kH264, false, "h264", "unknown"},
                                           VideoCase{ClipCodec::kH264, true, "h264", "pc"},
                                           VideoCase{ClipCodec::kH265, false, "hevc", "tv"},
                                           VideoCase{ClipCodec::kH265, true, "hevc", "pc"}),
                         [](const auto& test) {
                           return std::string(test.param.codec_name) + "_" + test.param.range_name;
                         });

}  // namespace
}  // namespace velamap
