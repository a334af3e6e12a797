// Reads a video with FFmpeg's libraries: frames in order of presentation, numbered from 0.

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "importer/video/video_picture.h"

namespace velamap {

struct VideoFrame {
  int number = 0;                // the number of frames that the decoder yields before it
  std::optional<double> time_s;  // since the video's start; correct for a variable frame rate, too
  VideoPicture picture;          // as stored, without the rotation of the metadata
};

class VideoDecoder {
 public:
  // Opens the first video stream of the file. `num_threads` threads decode it; 0 leaves the number
  // to FFmpeg. Throws InputError if FFmpeg cannot read the file, or it holds no video or one
  // without a decoder.
  VideoDecoder(const std::string& path, int num_threads);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  // The number that the container states, which may be off by a frame or so; 0 if it states none.
  int NumContainerFrames() const;

  // Skips the frames before `number` without decoding more of them than that frame needs. To be
  // called before the first Next(), which then returns that frame (the last frame if there are
  // fewer), or frame 0 if frames of this video cannot be counted without decoding. The numbers of
  // frames stay the same.
  void SkipTo(int number);

  // Returns the next frame, or nothing at the end. Skips frames that cannot be decoded.
  std::optional<VideoFrame> Next();

  // The number of frames of the video, once Next() has returned nothing.
  int NumFramesRead() const;

 private:
  class Stream;

  std::string path_;
  int num_threads_;
  std::unique_ptr<Stream> stream_;
  int next_number_ = 0;
  bool has_frame_ = false;  // whether the next frame is decoded already
};

}  // namespace velamap
