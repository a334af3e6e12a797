#include "importer/video/video_picture.h"

#include <functional>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr int kWidth = 70, kHeight = 50;

// Fills the three planes of an 8-bit picture whose chroma has half the resolution.
VideoPicture MakePicture(int format, const std::function<int(int plane, int x, int y)>& value,
                         const cv::Size& size = {kWidth, kHeight}) {
  AVFrame* frame = av_frame_alloc();
  frame->width = size.width;
  frame->height = size.height;
  frame->format = format;
  EXPECT_EQ(av_frame_get_buffer(frame, 0), 0);
  for (int plane = 0; plane < 3; ++plane) {
    const int scale = plane == 0 ? 1 : 2;
    for (int y = 0; y < size.height / scale; ++y) {
      for (int x = 0; x < size.width / scale; ++x) {
        frame->data[plane][y * frame->linesize[plane] + x] =
            static_cast<std::uint8_t>(value(plane, x, y));
      }
    }
  }
  VideoPicture picture(*frame);
  av_frame_free(&frame);
  return picture;
}

int LumaRamp(int plane, int x, int y) { return plane == 0 ? (y * kWidth + x) % 256 : 128; }

TEST(VideoPicture, LimitedRangeIsStretchedAndFullRangeStays) {
  const cv::Mat limited = MakePicture(AV_PIX_FMT_YUV420P, LumaRamp).Gray();
  const cv::Mat full = MakePicture(AV_PIX_FMT_YUVJ420P, LumaRamp).Gray();
  ASSERT_EQ(limited.size(), cv::Size(kWidth, kHeight));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int luma = LumaRamp(0, x, y);
      EXPECT_EQ(full.at<std::uint8_t>(y, x), luma);
      EXPECT_EQ(limited.at<std::uint8_t>(y, x), luma < 16    ? 0
                                                : luma > 235 ? 255
                                                             : (luma - 16) * 255 / 219);
    }
  }
}

TEST(VideoPicture, GrayAgreesWithColorWhereThereIsNone) {
  const VideoPicture picture = MakePicture(AV_PIX_FMT_YUV420P, LumaRamp);
  const cv::Mat gray = picture.Gray(), color = picture.Color();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const cv::Vec3b& bgr = color.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(bgr[c], gray.at<std::uint8_t>(y, x));
    }
  }
}

// JPEG's own conversion (ITU-T T.871) of luma and chroma gives the colours.
TEST(VideoPicture, ChromaAndGrayAreTheColors) {
  for (const int format : {AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUVJ420P}) {
    const VideoPicture picture = MakePicture(format, [](int plane, int x, int y) {
      return plane == 0 ? 90 + (x + y) / 2 : 100 + (plane == 1 ? x : y);
    });
    const cv::Mat gray = picture.Gray(), color = picture.Color();
    const auto chroma = picture.HalfSizeChroma();
    ASSERT_TRUE(chroma);
    ASSERT_EQ(chroma->cb.size(), cv::Size(kWidth / 2, kHeight / 2));
    for (int y = 2; y < kHeight - 2; ++y) {
      for (int x = 2; x < kWidth - 2; ++x) {
        const double cb = chroma->cb.at<std::uint8_t>(y / 2, x / 2) - 128.0;
        const double cr = chroma->cr.at<std::uint8_t>(y / 2, x / 2) - 128.0;
        const double luma = gray.at<std::uint8_t>(y, x);
        const cv::Vec3b& bgr = color.at<cv::Vec3b>(y, x);
        EXPECT_NEAR(bgr[0], luma + 1.772 * cb, 4.0);
        EXPECT_NEAR(bgr[1], luma - 0.344136 * cb - 0.714136 * cr, 4.0);
        EXPECT_NEAR(bgr[2], luma + 1.402 * cr, 4.0);
      }
    }
  }
  EXPECT_FALSE(
      MakePicture(AV_PIX_FMT_YUV420P10LE, [](int, int, int) { return 0; }).HalfSizeChroma());
  for (const cv::Size size : {cv::Size(kWidth - 1, kHeight), cv::Size(kWidth, kHeight - 1)}) {
    const VideoPicture odd = MakePicture(
        AV_PIX_FMT_YUV420P, [](int, int, int) { return 99; }, size);
    EXPECT_EQ(odd.Gray().size(), size);
    EXPECT_FALSE(odd.HalfSizeChroma());
  }
}

TEST(VideoPicture, SinglePixelsHaveTheColorsOfTheWholePicture) {
  const VideoPicture picture = MakePicture(AV_PIX_FMT_YUV420P, [](int plane, int x, int y) {
    return 60 + (7 * x + 13 * y + 50 * plane) % 120;
  });
  std::vector<cv::Point> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) pixels.emplace_back(x, y);
  }
  const std::vector<cv::Vec3b> colors = picture.ColorsAt(pixels);
  const cv::Mat color = picture.Color();
  ASSERT_EQ(colors.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    EXPECT_EQ(colors[i], color.at<cv::Vec3b>(pixels[i])) << pixels[i];
  }
}

}  // namespace
}  // namespace velamap
