// Writes the frames of a clip to image files, or to an H.264 or H.265 video with the ffmpeg
// program.

#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace velamap {

enum class ClipFormat { kMp4, kPng, kJpg };
enum class ClipCodec { kH264, kH265 };

struct ClipWriterOptions {
  ClipFormat format = ClipFormat::kMp4;
  double fps = 30.0;
  ClipCodec codec = ClipCodec::kH264;
  bool full_range = false;          // luma of the video from 0 to 255 instead of 16 to 235
  int crf = 18;                     // constant rate factor, 0 (H.264: lossless) to 51
  std::string bitrate{};            // instead of crf, in the notation of ffmpeg: 30M
  std::string preset = "veryfast";  // of x264 or x265

  void Check() const;  // throws InputError
};

// Writes frames (BGR, all of the same size) in order. Throws ExternalToolError if ffmpeg fails, and
// InputError if an image cannot be written.
class ClipWriter {
 public:
  // Writes the video folder/clip.mp4 or the images folder/images/frame_000000.png and so on.
  // `folder` must exist.
  ClipWriter(const std::filesystem::path& folder, const ClipWriterOptions& options);
  ~ClipWriter();
  ClipWriter(const ClipWriter&) = delete;
  ClipWriter& operator=(const ClipWriter&) = delete;

  void Write(const cv::Mat& frame);
  void Finish();  // waits for ffmpeg

  // The video or the folder of images.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::vector<std::string> FfmpegArguments(const cv::Size& size) const;
  void StartFfmpeg(const cv::Size& size);

  ClipWriterOptions options_;
  std::filesystem::path path_;
  int num_frames_ = 0;
  int child_pid_ = -1;
  std::FILE* pipe_ = nullptr;
};

}  // namespace velamap
