// Short clips that the ffmpeg program makes.

#pragma once

#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace velamap {

constexpr int kNumClipFrames = 75;
constexpr double kClipFramesPerSecond = 25.0;

// Frames are grey, so that no colour is too saturated for BGR, and differ from each other.
// `encoding`: options of ffmpeg.
inline void MakeGreyClip(const std::string& path, const std::string& encoding) {
  const std::string command = fmt::format(
      "ffmpeg -loglevel error -y -f lavfi -i testsrc2=size=176x100:rate={} -frames:v {} "
      "-vf hue=s=0,format=yuv420p -threads 1 {} '{}'",
      kClipFramesPerSecond, kNumClipFrames, encoding, path);
  ASSERT_EQ(std::system(command.c_str()), 0) << command << ": is ffmpeg installed?";
}

// The name of a test with a clip: the file's, without the dot.
template <typename Clip>
std::string ClipName(const testing::TestParamInfo<Clip>& info) {
  std::string name = info.param.file_name;
  name[name.find('.')] = '_';
  return name;
}

}  // namespace velamap
