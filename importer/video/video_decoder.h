// Reads a video with FFmpeg's libraries: frames in order of presentation, numbered from 0.

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "importer/video/video_picture.h"

namespace velamap {

struct VideoFrame {
  int number = 0;  // the number of frames that the decoder yields before it
  // Since the video's start; also correct for a variable frame rate. Never earlier than the time of
  // the frame before: where the file's times run backwards, such as after a cut, they continue at
  // the frame rate.
  std::optional<double> time_s;
  VideoPicture picture;  // turned as the metadata say: NumQuarterTurns()
  bool is_whole = true;  // false: the file is damaged there, or before, up to a key frame
};

// FFmpeg's state.
class VideoStream;

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

  // Number of clockwise 90-degree rotations for display, as the metadata of the video say.
  // cv::VideoCapture also rotates frames, so calibrations made from a video are for rotated frames;
  // version 4.6 rotates in the wrong direction (github.com/opencv/opencv/issues/22088).
  int NumQuarterTurns() const;

  // Whether the container says that the video is interlaced. Its frames may also say so.
  bool IsMarkedInterlaced() const;

  // Skips the frames before `number` without decoding more of them than that frame needs. To be
  // called before the first Next(), which then returns that frame (the last frame if there are
  // fewer), or frame 0 if frames of this video cannot be counted without decoding. The numbers of
  // frames stay the same.
  void SkipTo(int number);

  // Returns the next frame, or nothing at the end. Skips frames that cannot be decoded.
  std::optional<VideoFrame> Next();

 private:
  // `time_s` plus `time_offset_s_`, which grows where the result would be earlier than the last
  // frame's time: the times then continue at the frame rate.
  double TimeInOrder(double time_s, double frames_per_second);

  std::string path_;
  int num_threads_;
  std::unique_ptr<VideoStream> stream_;
  int num_quarter_turns_ = 0;
  int next_number_ = 0;
  std::optional<double> last_time_s_;
  double time_offset_s_ = 0.0;  // added to the file's times so that they never run backwards
  bool has_frame_ = false;      // whether the next frame is decoded already
};

}  // namespace velamap
