// One picture of a video as FFmpeg decoded it. Its luma plane is the grey image already, so that
// colours are converted only where they are asked for.

#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

struct AVFrame;

namespace velamap {

// 8 bit, a value for two by two pixels, 128 for grey and all of 0 to 255 in use (as in JPEG).
struct ChromaPlanes {
  cv::Mat cb, cr;
};

// A value that shares the decoder's memory; safe to read on many threads.
class VideoPicture {
 public:
  // Takes a reference of its own; no pixel is copied.
  explicit VideoPicture(const AVFrame& frame);

  // 8-bit grey, 0 black and 255 white: luma of limited range (16 to 235) is stretched. To one grey
  // level what BGR turned into grey gives, except where a colour is too saturated for BGR: there
  // it was clipped. Empty if FFmpeg cannot convert the pixel format.
  cv::Mat Gray() const;

  // BGR, 8 bit, of the whole picture; empty if FFmpeg cannot convert the pixel format.
  cv::Mat Color() const;

  // The chroma that belongs to Gray(); nothing where the picture does not hold it in this way.
  std::optional<ChromaPlanes> HalfSizeChroma() const;

  // Color() of single pixels inside the picture, without converting the rest of it.
  std::vector<cv::Vec3b> ColorsAt(const std::vector<cv::Point>& pixels) const;

 private:
  std::shared_ptr<const AVFrame> frame_;
};

}  // namespace velamap
