// Reads a video with FFmpeg's own libraries: frames in order of presentation, numbered from 0.

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "importer/video/video_picture.h"

namespace velamap {

struct VideoFrame {
  int number = 0;                // how many frames the decoder yields before it
  std::optional<double> time_s;  // from the video's start; also right for a variable frame rate
  VideoPicture picture;          // as it is stored: never rotated by metadata
};

class VideoDecoder {
 public:
  // The first video stream of the file. `num_threads` decode, 0: as FFmpeg thinks best. Throws
  // InputError: no file that FFmpeg can read, no video in it, no decoder for it.
  VideoDecoder(const std::string& path, int num_threads);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  // By the container, which may be off by a frame or so; 0 when it does not say.
  int NumContainerFrames() const;

  // Before the first Next(): pass over the frames before `number` without decoding more of them
  // than that frame needs. Next() then begins with it (with the last one, if there are fewer), or
  // with frame 0 where the video does not let frames be counted without decoding. Numbers stay the
  // same.
  void SkipTo(int number);

  // The next frame, or nothing at the end. What cannot be decoded is passed over.
  std::optional<VideoFrame> Next();

  // How many frames there are up to the end, once Next() has yielded nothing.
  int NumFramesRead() const;

 private:
  class Stream;

  std::string path_;
  int num_threads_;
  std::unique_ptr<Stream> stream_;
  int next_number_ = 0;
  bool has_frame_ = false;  // the next frame is decoded already
};

}  // namespace velamap
