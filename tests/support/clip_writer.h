// Where the frames of a clip go: an H.264 video, encoded by the ffmpeg program, or image files.

#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

namespace velamap {

enum class ClipFormat { kMp4, kPng, kJpg };

struct ClipWriterOptions {
  ClipFormat format = ClipFormat::kMp4;
  double fps = 30.0;
  int crf = 18;                     // constant quality of the video, 0 (lossless) to 51
  std::string bitrate{};            // instead of crf, as ffmpeg takes it: 30M
  std::string preset = "veryfast";  // of x264

  void Check() const;  // throws InputError
};

// Writes frames (BGR, all of one size) in order. Throws ExternalToolError when ffmpeg fails,
// InputError when an image cannot be written.
class ClipWriter {
 public:
  // Video: folder/clip.mp4; images: folder/images/frame_000000.png. The folder must exist.
  ClipWriter(const std::filesystem::path& folder, const ClipWriterOptions& options);
  ~ClipWriter();
  ClipWriter(const ClipWriter&) = delete;
  ClipWriter& operator=(const ClipWriter&) = delete;

  void Write(const cv::Mat& frame);
  void Finish();  // waits for ffmpeg

  // The video or the folder of images.
  const std::filesystem::path& path() const { return path_; }

 private:
  void StartFfmpeg(const cv::Size& size);

  ClipWriterOptions options_;
  std::filesystem::path path_;
  int num_frames_ = 0;
  int child_pid_ = -1;
  std::FILE* pipe_ = nullptr;
};

}  // namespace velamap
