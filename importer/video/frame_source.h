// A stream of frames from a folder of images or a video file. Nothing is decoded twice, and one
// frame at a time is in memory.

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/video/video_options.h"
#include "importer/video/video_picture.h"

namespace velamap {

struct Frame {
  std::string image_name;           // images: path relative to the folder; video: frame_000123.jpg
  std::optional<int> frame_number;  // video only, zero-based
  std::optional<double> time_s;     // video only
  // Pixels are never rotated by metadata, as COLMAP reads them. A video's colours are converted
  // only where they are asked for: see ColorImage() and detect/corner_colors.h.
  cv::Mat gray;                         // 8 bit, once the frame is loaded
  cv::Mat color;                        // images only: BGR, 8 bit, once loaded
  std::optional<VideoPicture> picture;  // video only
  double decode_s = 0.0;                // video only: wall time of Next()
};

// The whole frame, BGR, 8 bit.
cv::Mat ColorImage(const Frame& frame);

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame, or nothing at the end. An unreadable image is skipped with a warning.
  virtual std::optional<Frame> Next() = 0;

  // Next() hands out frames without pixels and Load() fills them, so that what can be done on many
  // threads is: decoding of an image file, the grey image of a picture of a video. Thread-safe.
  // False, with a warning and the reason, if the file is no whole image.
  virtual bool Load(Frame* frame, std::string* reason) const = 0;

  virtual bool IsVideo() const = 0;

  // How many frames are to come at most; 0 when the container does not say.
  virtual int NumFrames() const = 0;
};

// `path` is a folder (searched recursively, hidden files left out, natural order of names) or a
// video file. Throws InputError: nothing there, empty folder, not a video that FFmpeg can read.
// Frames whose name is in `known_names` are passed over without being decoded where possible.
// `num_threads` decode a video; 0: as FFmpeg thinks best.
std::unique_ptr<FrameSource> OpenFrameSource(const std::string& path, const VideoOptions& options,
                                             const std::vector<std::string>& known_names = {},
                                             int num_threads = 0);

}  // namespace velamap
