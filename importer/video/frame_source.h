// A stream of frames from a folder of images or a video file. No frame is decoded twice.

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/video/source_file.h"
#include "importer/video/video_options.h"
#include "importer/video/video_picture.h"

namespace velamap {

struct Frame {
  std::string image_name;  // photographs: path relative to the folder; video: frame_000123.jpg
  std::optional<int> frame_number;  // video only, zero-based
  std::optional<double> time_s;     // video only
  // The metadata of a photograph never turn its pixels, because COLMAP does not turn them either.
  // Those of a video do, as in players and cv::VideoCapture. A video's colours are converted on
  // demand only: see ColorImage() and detect/corner_colors.h.
  cv::Mat gray;                         // 8 bit, once the frame is loaded
  cv::Mat color;                        // photographs only: BGR, 8 bit, once loaded
  std::optional<VideoPicture> picture;  // video only
  double reading_s = 0.0;               // video only: wall time of Next()
  // False if this frame of a video is damaged or predicted from a damaged one.
  bool is_whole = true;
  std::optional<SourceFile> source;  // photographs only, once loaded
};

// The whole frame, BGR, 8 bit.
cv::Mat ColorImage(const Frame& frame);

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Returns the next frame, or nothing at the end.
  virtual std::optional<Frame> Next() = 0;

  // Fills the pixels of a frame, which Next() leaves empty so that many threads can decode image
  // files and compute grey images in parallel. Thread-safe. Returns false, with a warning and the
  // reason, if the file is not a whole image, and without a warning for a frame that is not whole,
  // because one packet may damage hundreds of them. Throws InputError for an interlaced video whose
  // two fields show different moments.
  virtual bool Load(Frame* frame, std::string* reason) const = 0;

  virtual bool IsVideo() const = 0;

  // The largest number of frames to come; 0 if the container does not say.
  virtual int NumFrames() const = 0;
};

// Throws InputError unless `path` is a folder or a file that may be a video.
void CheckImagePath(const std::string& path);

// Returns the aspect ratio of a pixel (width / height) that the video states; 1 if it states none,
// and for a folder of images. Throws InputError if FFmpeg cannot read the video.
double PixelAspect(const std::string& path);

std::string NameOfVideoFrame(int frame_number);

// The number of the frame of a video that has such a name; nothing for other names.
std::optional<int> NumberOfVideoFrame(const std::string& name);

// `path` is a folder (with its sub-folders and without hidden files, in natural order of names) or
// a video file. Throws InputError if there is nothing, the folder holds no images, or FFmpeg cannot
// read the video. Frames whose name is in `known_names` are skipped, without being decoded where
// possible. `num_threads` threads decode a video; 0 leaves the number to FFmpeg.
std::unique_ptr<FrameSource> OpenFrameSource(const std::string& path, const VideoOptions& options,
                                             const std::vector<std::string>& known_names = {},
                                             int num_threads = 0);

}  // namespace velamap
