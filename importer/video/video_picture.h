// One picture of a video as FFmpeg decoded it. Its luma plane serves as the grey image; colours are
// converted on demand only.

#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

struct AVFrame;

namespace velamap {

// 8 bit, one value for two by two pixels, 128 for grey, range 0 to 255, as in JPEG.
struct ChromaPlanes {
  cv::Mat cb, cr;
};

// A value that shares the decoder's memory. Many threads may read it.
class VideoPicture {
 public:
  // Takes its own reference and copies no pixels. All that follows is turned clockwise by
  // `num_quarter_turns` (0 to 3).
  explicit VideoPicture(const AVFrame& frame, int num_quarter_turns = 0);

  // Whether the stream says that the picture has two fields, which may show the same moment.
  bool IsMarkedInterlaced() const;

  // 8-bit grey, 0 for black and 255 for white; luma of limited range (16 to 235) is stretched.
  // Equal to grey computed from BGR to one grey level, except for colours that BGR clips because
  // they are too saturated. Empty if FFmpeg cannot convert the pixel format.
  cv::Mat Gray() const;

  // The whole picture in BGR, 8 bit. Empty if FFmpeg cannot convert the pixel format.
  cv::Mat Color() const;

  // The chroma that belongs to Gray(). Returns nothing if the picture stores it in another way, or
  // has an odd size, where the last values belong to half as many pixels (the first ones, once
  // turned).
  std::optional<ChromaPlanes> HalfSizeChroma() const;

  // Color() of single pixels, without converting the rest of the picture.
  std::vector<cv::Vec3b> ColorsAt(const std::vector<cv::Point>& pixels) const;

 private:
  cv::Mat Turned(const cv::Mat& stored) const;
  cv::Point StoredPixel(const cv::Point& pixel) const;

  std::shared_ptr<const AVFrame> frame_;
  int num_quarter_turns_;
};

}  // namespace velamap
