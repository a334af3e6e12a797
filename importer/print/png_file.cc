#include "importer/print/png_file.h"

#include <cmath>
#include <stdexcept>

#include <png.h>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

void Append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

void Flush(png_structp) {}

// libpng's default error handler uses longjmp(), for which nothing here calls setjmp().
[[noreturn]] void Fail(png_structp, png_const_charp message) {
  throw std::logic_error(std::string("libpng: ") + message);
}

}  // namespace

std::string EncodePng(const cv::Mat& image, std::optional<double> px_per_mm) {
  VELAMAP_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3);
  const bool is_gray = image.channels() == 1;
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, Fail, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &bytes, Append, Flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols),
               static_cast<png_uint_32>(image.rows), 8,
               is_gray ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (px_per_mm) {
    const auto px_per_m = static_cast<png_uint_32>(std::lround(1000 * *px_per_mm));
    png_set_pHYs(png, info, px_per_m, px_per_m, PNG_RESOLUTION_METER);
  }
  png_write_info(png, info);
  if (!is_gray) png_set_bgr(png);
  for (int row = 0; row < image.rows; ++row) png_write_row(png, image.ptr(row));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::string MarkerPng(const cv::Mat& cells, double length_mm, double margin_mm, double dpi) {
  const double cell_mm = length_mm / cells.cols;
  const int cell_px = std::max(1, static_cast<int>(std::ceil(cell_mm * dpi / kMmPerInch - 1e-9)));
  const double px_per_mm = cell_px / cell_mm;
  const int margin_px = static_cast<int>(std::lround(margin_mm * px_per_mm));
  cv::Mat gray;
  cv::resize(cells, gray, {}, cell_px, cell_px, cv::INTER_NEAREST);
  cv::copyMakeBorder(gray, gray, margin_px, margin_px, margin_px, margin_px, cv::BORDER_CONSTANT,
                     cv::Scalar(255));
  return EncodePng(gray, px_per_mm);
}

}  // namespace velamap
