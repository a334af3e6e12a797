#include "importer/video/video_picture.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <new>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include "importer/base/error.h"

namespace velamap {
namespace {

using FramePtr = std::unique_ptr<AVFrame, void (*)(AVFrame*)>;
using ScalerPtr = std::unique_ptr<SwsContext, void (*)(SwsContext*)>;

FramePtr Reference(const AVFrame& frame) {
  FramePtr copy(av_frame_clone(&frame), [](AVFrame* owned) { av_frame_free(&owned); });
  if (copy == nullptr) throw std::bad_alloc();
  return copy;
}

const AVPixFmtDescriptor* Format(const AVFrame& frame) {
  return av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
}

bool HasFlag(const AVPixFmtDescriptor& format, int flags) {
  return (format.flags & static_cast<std::uint64_t>(flags)) != 0;
}

// Grey formats always have full range, as in swscale.
bool IsFullRange(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = Format(frame);
  return frame.color_range == AVCOL_RANGE_JPEG || format->nb_components <= 2 ||
         std::strncmp(format->name, "yuvj", 4) == 0;
}

// Whether the first plane is the luma with one byte per pixel.
bool HasPlainLuma(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = Format(frame);
  const AVComponentDescriptor& luma = format->comp[0];
  return !HasFlag(*format, AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                               AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BAYER) &&
         luma.plane == 0 && luma.step == 1 && luma.offset == 0 && luma.shift == 0 &&
         luma.depth == 8;
}

// Maps 16 ... kHigh to 0 ... 255 as n + n (271 - kHigh) / (kHigh - 16). The arithmetic fits 16
// bits, so that the compiler can process many pixels at a time.
template <int kHigh, int kFactor, int kRoundUp>
void StretchLimitedRange(const std::uint8_t* limited, int num_pixels, std::uint8_t* full) {
  for (int i = 0; i < num_pixels; ++i) {
    const auto level = static_cast<std::uint16_t>(std::clamp<int>(limited[i], 16, kHigh) - 16);
    full[i] = static_cast<std::uint8_t>(level + (std::uint32_t{level} * kFactor >> 16) +
                                        (level > 0 ? kRoundUp : 0));
  }
}

// Computes (y - 16) 255 / 219 rounded down, as swscale and OpenCV do for grey. The factor is 36 /
// 219 of 65536, rounded up.
void StretchLuma(const std::uint8_t* luma, int num_pixels, std::uint8_t* gray) {
  StretchLimitedRange<235, 10774, 0>(luma, num_pixels, gray);
}

// Computes 128 + (c - 128) 255 / 224, rounded. This is half a level more than (c - 16) 255 / 224,
// which is therefore rounded up. The factor is 31 / 224 of 65536, rounded down.
void StretchChroma(const std::uint8_t* limited, int num_pixels, std::uint8_t* full) {
  StretchLimitedRange<240, 9069, 1>(limited, num_pixels, full);
}

// Whether the planes are luma, Cb and Cr with one byte per value, chroma of half the width and
// height.
bool HasPlainHalfSizeChroma(const AVFrame& frame) {
  return frame.format == AV_PIX_FMT_YUV420P || frame.format == AV_PIX_FMT_YUVJ420P;
}

cv::Mat FullRangeChroma(const AVFrame& frame, int plane) {
  const cv::Mat limited((frame.height + 1) / 2, (frame.width + 1) / 2, CV_8UC1, frame.data[plane],
                        static_cast<std::size_t>(frame.linesize[plane]));
  if (IsFullRange(frame)) return limited.clone();
  cv::Mat full(limited.size(), CV_8UC1);
  for (int y = 0; y < full.rows; ++y) StretchChroma(limited.ptr(y), full.cols, full.ptr(y));
  return full;
}

// Makes a converter that keeps the size. Null if FFmpeg cannot convert the format.
ScalerPtr MakeScaler(const AVFrame& frame, AVPixelFormat target, int flags) {
  ScalerPtr scaler(sws_alloc_context(), sws_freeContext);
  if (scaler == nullptr) throw std::bad_alloc();
  for (const auto& [name, value] :
       std::initializer_list<std::pair<const char*, int>>{{"srcw", frame.width},
                                                          {"srch", frame.height},
                                                          {"src_format", frame.format},
                                                          {"src_range", IsFullRange(frame) ? 1 : 0},
                                                          {"dstw", frame.width},
                                                          {"dsth", frame.height},
                                                          {"dst_format", target},
                                                          {"sws_flags", flags}}) {
    VELAMAP_CHECK(av_opt_set_int(scaler.get(), name, value, 0) >= 0);
  }
  if (sws_init_context(scaler.get(), nullptr, nullptr) < 0) scaler.reset();
  return scaler;
}

// Aligns rows to 64 bytes, so that swscale's fast loops can process whole rows.
cv::Mat MakeImage(int width, int height, int type) {
  constexpr int kAlignment = 64;
  return cv::Mat(height, (width + kAlignment - 1) / kAlignment * kAlignment, type)
      .colRange(0, width);
}

bool Scale(SwsContext* scaler, const AVFrame& frame, cv::Mat* image) {
  std::uint8_t* const planes[] = {image->data, nullptr, nullptr, nullptr};
  const int strides[] = {static_cast<int>(image->step), 0, 0, 0};
  return sws_scale(scaler, frame.data, frame.linesize, 0, frame.height, planes, strides) ==
         frame.height;
}

cv::Mat Convert(const AVFrame& frame, AVPixelFormat target, int type, int flags) {
  const ScalerPtr scaler = MakeScaler(frame, target, flags);
  if (scaler == nullptr) return {};
  cv::Mat image = MakeImage(frame.width, frame.height, type);
  return Scale(scaler.get(), frame, &image) ? image : cv::Mat();
}

// Converts as OpenCV's VideoCapture does, so that both yield the same colours.
cv::Mat ConvertToColor(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = Format(frame);
  if (HasFlag(*format, AV_PIX_FMT_FLAG_RGB) && format->comp[0].depth == 16 &&
      !HasFlag(*format, AV_PIX_FMT_FLAG_PLANAR | AV_PIX_FMT_FLAG_FLOAT)) {
    // For 8 bits swscale converts via YUV, which is off by up to two levels.
    cv::Mat image = Convert(frame, AV_PIX_FMT_BGR48LE, CV_16UC3, SWS_BICUBIC);
    image.convertTo(image, CV_8U, 255.0 / 65535.0);
    return image;
  }
  return Convert(frame, AV_PIX_FMT_BGR24, CV_8UC3, SWS_BICUBIC);
}

// A patch around the pixel, aligned to the coarsest chroma (4 px) and large enough for the filter.
cv::Rect PatchAround(const cv::Point& pixel, const cv::Rect& bounds) {
  const cv::Rect patch(pixel.x / 8 * 8 - 8, pixel.y / 4 * 4 - 8, 24, 20);
  return patch & bounds;
}

FramePtr Crop(const AVFrame& frame, const cv::Rect& patch) {
  FramePtr part = Reference(frame);
  part->crop_left = static_cast<std::size_t>(patch.x);
  part->crop_top = static_cast<std::size_t>(patch.y);
  part->crop_right = static_cast<std::size_t>(frame.width - patch.br().x);
  part->crop_bottom = static_cast<std::size_t>(frame.height - patch.br().y);
  VELAMAP_CHECK(av_frame_apply_cropping(part.get(), AV_FRAME_CROP_UNALIGNED) >= 0);
  return part;
}

}  // namespace

VideoPicture::VideoPicture(const AVFrame& frame, int num_quarter_turns)
    : frame_(Reference(frame)), num_quarter_turns_(num_quarter_turns) {
  VELAMAP_CHECK(num_quarter_turns >= 0 && num_quarter_turns < 4);
}

bool VideoPicture::IsMarkedInterlaced() const { return frame_->interlaced_frame != 0; }

cv::Mat VideoPicture::Turned(const cv::Mat& stored) const {
  constexpr std::array<cv::RotateFlags, 3> kTurns = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                                     cv::ROTATE_90_COUNTERCLOCKWISE};
  if (num_quarter_turns_ == 0 || stored.empty()) return stored;
  cv::Mat turned;
  cv::rotate(stored, turned, kTurns[static_cast<std::size_t>(num_quarter_turns_ - 1)]);
  return turned;
}

cv::Point VideoPicture::StoredPixel(const cv::Point& pixel) const {
  const cv::Point last(frame_->width - 1, frame_->height - 1);
  switch (num_quarter_turns_) {
    case 1:
      return {pixel.y, last.y - pixel.x};
    case 2:
      return last - pixel;
    case 3:
      return {last.x - pixel.y, pixel.x};
    default:
      return pixel;
  }
}

cv::Mat VideoPicture::Gray() const {
  if (!HasPlainLuma(*frame_)) {
    return Turned(Convert(*frame_, AV_PIX_FMT_GRAY8, CV_8UC1, SWS_BICUBIC));
  }
  cv::Mat gray(frame_->height, frame_->width, CV_8UC1);
  const bool is_full_range = IsFullRange(*frame_);
  for (int y = 0; y < gray.rows; ++y) {
    const std::uint8_t* luma =
        frame_->data[0] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[0];
    if (is_full_range) {
      std::memcpy(gray.ptr(y), luma, static_cast<std::size_t>(gray.cols));
    } else {
      StretchLuma(luma, gray.cols, gray.ptr(y));
    }
  }
  return Turned(gray);
}

cv::Mat VideoPicture::Color() const { return Turned(ConvertToColor(*frame_)); }

std::optional<ChromaPlanes> VideoPicture::HalfSizeChroma() const {
  const bool has_odd_size = frame_->width % 2 != 0 || frame_->height % 2 != 0;
  if (!HasPlainHalfSizeChroma(*frame_) || has_odd_size) return std::nullopt;
  return ChromaPlanes{Turned(FullRangeChroma(*frame_, 1)), Turned(FullRangeChroma(*frame_, 2))};
}

std::vector<cv::Vec3b> VideoPicture::ColorsAt(const std::vector<cv::Point>& pixels) const {
  std::vector<cv::Vec3b> colors(pixels.size());
  const cv::Rect bounds(0, 0, frame_->width, frame_->height);
  // These formats share bytes between pixels, so no patch can be cut out.
  const bool is_whole = HasFlag(*Format(*frame_), AV_PIX_FMT_FLAG_BITSTREAM);
  ScalerPtr scaler(nullptr, sws_freeContext);
  cv::Mat image;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point pixel = StoredPixel(pixels[i]);
    VELAMAP_CHECK(bounds.contains(pixel));
    const cv::Rect patch = is_whole ? bounds : PatchAround(pixel, bounds);
    const FramePtr part = Crop(*frame_, patch);
    if (image.size() != patch.size()) {
      scaler = MakeScaler(*part, AV_PIX_FMT_BGR24, SWS_BICUBIC);
      if (scaler == nullptr) return colors;
      image = MakeImage(patch.width, patch.height, CV_8UC3);
    }
    if (Scale(scaler.get(), *part, &image)) colors[i] = image.at<cv::Vec3b>(pixel - patch.tl());
  }
  return colors;
}

}  // namespace velamap
