// A stream of frames from a folder of images or a video file. Nothing is read twice, and one frame
// at a time is in memory.

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/options.h"

namespace velamap {

struct Frame {
  std::string image_name;           // images: path relative to the folder; video: frame_000123.jpg
  std::optional<int> frame_number;  // video only, zero-based
  std::optional<double> time_s;     // video only
  cv::Mat color;                    // BGR, 8 bit; never rotated by metadata, as COLMAP reads it
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame, or nothing at the end. An unreadable image is skipped with a warning.
  virtual std::optional<Frame> Next() = 0;

  // Decoding of an image file can be left to the thread that uses it; a video is sequential.
  // For images Next() hands out frames without pixels and Load() fills them; thread-safe. False,
  // with a warning and the reason, if the file is no whole image.
  virtual bool Load(Frame* frame, std::string* reason) const = 0;

  virtual bool IsVideo() const = 0;

  // How many frames are to come at most; 0 when the container does not say.
  virtual int NumFrames() const = 0;
};

// `path` is a folder (searched recursively, hidden files left out, natural order of names) or a
// video file. Throws InputError: nothing there, empty folder, not a video that OpenCV can read.
// Frames whose name is in `known_names` are passed over without being decoded where possible.
std::unique_ptr<FrameSource> OpenFrameSource(const std::string& path, const VideoOptions& options,
                                             const std::vector<std::string>& known_names = {});

}  // namespace velamap
