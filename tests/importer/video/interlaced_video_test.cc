// Interlaced clips, which the ffmpeg program makes.

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/video/frame_source.h"
#include "importer/video/interlacing.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Clip {
  const char* file_name;
  const char* encoding;  // options of ffmpeg, with filters
};

// What reading the clip ends with: "whole" or the error.
std::string Read(const Clip& clip) {
  const TempDir dir;
  const std::string path = dir / clip.file_name;
  const std::string command = fmt::format(
      "ffmpeg -loglevel error -y -f lavfi -i testsrc2=size=320x240:rate=50 -frames:v 8 {} '{}'",
      clip.encoding, path);
  if (std::system(command.c_str()) != 0) return command + ": is ffmpeg installed?";
  try {
    const auto source = OpenFrameSource(path, {});
    std::string reason;
    while (std::optional<Frame> frame = source->Next()) {
      if (!source->Load(&*frame, &reason)) return reason;
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "whole";
}

TEST(InterlacedVideo, FieldsOfTwoMomentsAreRefusedWithTheRemedy) {
  constexpr const char* kWoven = "-vf tinterlace=interleave_top,setfield=tff,format=yuv420p ";
  for (const auto& [file_name, encoding] : std::vector<std::pair<const char*, std::string>>{
           {"h264.mp4", "-c:v libx264 -crf 12 -flags +ilme+ildct -x264opts tff=1"},
           {"h264.ts", "-c:v libx264 -crf 12 -flags +ilme+ildct -x264opts tff=1"},
           {"mpeg2.mpg", "-c:v mpeg2video -q:v 2 -flags +ilme+ildct"},
           {"motion_jpeg.mov", "-c:v mjpeg -q:v 2"}}) {
    const std::string options = kWoven + encoding;
    EXPECT_THAT(Read({file_name, options.c_str()}),
                AllOf(HasSubstr(file_name), HasSubstr("is interlaced"), HasSubstr("-vf bwdif")));
  }
}

TEST(InterlacedVideo, WholePicturesAreReadHoweverTheyAreStored) {
  for (const Clip& clip :
       {Clip{"h264.mp4", "-vf setfield=tff -c:v libx264 -flags +ilme+ildct -x264opts tff=1"},
        Clip{"mpeg2.mpg", "-vf setfield=tff -c:v mpeg2video -q:v 2 -flags +ilme+ildct -r 25"},
        Clip{"remedy.mp4",
             "-vf tinterlace=interleave_top,setfield=tff,bwdif,format=yuv420p -c:v libx264"}}) {
    EXPECT_EQ(Read(clip), "whole") << clip.file_name;
  }
}

TEST(InterlacedVideo, BlindsInAFewPicturesAreNoFields) {
  // Every second line of two pictures of 25 is dark, and all pictures are stored as interlaced.
  constexpr const char* kStored =
      "setfield=tff -c:v libx264 -crf 12 -flags +ilme+ildct -x264opts tff=1";
  const std::string blinds =
      "-frames:v 25 -vf format=yuv420p,geq=lum='if({}\\,if(mod(Y\\,2)\\,40\\,200)\\,lum(X\\,Y))'"
      ":cb=128:cr=128,";
  const std::string few = fmt::format(blinds, "between(N\\,7\\,8)") + kStored;
  const std::string all = fmt::format(blinds, "1") + kStored;
  EXPECT_EQ(Read({"few.mp4", few.c_str()}), "whole");
  EXPECT_THAT(Read({"all.mp4", all.c_str()}), HasSubstr("is interlaced"));
}

// A picture whose odd lines are those of another moment.
cv::Mat Weave(const cv::Mat& first, const cv::Mat& second) {
  cv::Mat woven = first.clone();
  for (int y = 1; y < woven.rows; y += 2) second.row(y).copyTo(woven.row(y));
  return woven;
}

TEST(IsCombed, NoiseAndTextureAreNoCombs) {
  cv::RNG random(1);
  cv::Mat noise(240, 320, CV_8UC1);
  random.fill(noise, cv::RNG::NORMAL, 128, 40);
  EXPECT_FALSE(IsCombed(noise));
  EXPECT_FALSE(IsCombed(cv::Mat(240, 320, CV_8UC1, cv::Scalar(90))));
  EXPECT_FALSE(IsCombed(cv::Mat(1, 1, CV_8UC1, cv::Scalar(90))));
  cv::Mat smooth;
  cv::GaussianBlur(noise, smooth, {}, 1.0);
  smooth = (smooth - 128) * 6 + 128;
  EXPECT_FALSE(IsCombed(smooth));
  EXPECT_FALSE(IsCombed(Weave(smooth, smooth)));
}

// Of a camera that interpolates its colour filter array bilinearly and sharpens.
TEST(IsCombed, ZippersOfAColourFilterArrayAreNoCombs) {
  for (const double slant : {0.02, 0.05, 0.1}) {
    cv::Mat mosaic(240, 320, CV_8UC1);
    for (int y = 0; y < mosaic.rows; ++y) {
      for (int x = 0; x < mosaic.cols; ++x) {
        const double u = x + slant * y, v = y - slant * x;
        const bool is_dark = std::fmod(u + 1000, 60) < 30 && std::fmod(v + 1000, 60) < 30;
        mosaic.at<std::uint8_t>(y, x) = is_dark ? 60 : 200;
      }
    }
    cv::Mat color, gray, blurred;
    cv::demosaicing(mosaic, color, cv::COLOR_BayerBG2BGR);
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(gray, blurred, {}, 1.0);
    cv::addWeighted(gray, 2.2, blurred, -1.2, 0.0, gray);
    EXPECT_FALSE(IsCombed(gray)) << slant;
  }
}

TEST(IsCombed, MovedEdgesAreCombs) {
  for (const int moved_px : {1, 2, 20}) {
    cv::Mat first(240, 320, CV_8UC1, cv::Scalar(220)), second = first.clone();
    cv::rectangle(first, {100, 60, 80, 80}, cv::Scalar(20), cv::FILLED);
    cv::rectangle(second, {100 + moved_px, 60, 80, 80}, cv::Scalar(20), cv::FILLED);
    EXPECT_TRUE(IsCombed(Weave(first, second))) << moved_px;
    EXPECT_FALSE(IsCombed(first)) << moved_px;
    EXPECT_FALSE(IsCombed(second)) << moved_px;
  }
}

}  // namespace
}  // namespace velamap
