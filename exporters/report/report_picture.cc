#include "exporters/report/report_picture.h"

#include <algorithm>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/video/image_file.h"
#include "importer/video/jpeg_codec.h"

namespace velamap {
namespace {

constexpr int kJpegQuality = 82;

}  // namespace

ReportPicture MakeReportPicture(const std::string& image_path, int max_side_px) {
  ReportPicture picture;
  cv::Mat image = DecodeImageFile(image_path, &picture.problem);
  if (image.empty()) return picture;
  picture.problem.clear();
  const double scale = static_cast<double>(max_side_px) / std::max(image.cols, image.rows);
  if (scale < 1) cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  picture.jpeg_base64 = Base64(EncodeJpeg(image, kJpegQuality));
  return picture;
}

std::string Base64(const std::string& bytes) {
  using boost::archive::iterators::base64_from_binary;
  using boost::archive::iterators::transform_width;
  using Encoder = base64_from_binary<transform_width<const char*, 6, 8>>;
  // The iterator reads whole groups of three bytes. Zeros fill the last one, and their characters
  // become the padding.
  const std::size_t num_missing = (3 - bytes.size() % 3) % 3;
  const std::string padded = bytes + std::string(num_missing, '\0');
  std::string text(Encoder(padded.data()), Encoder(padded.data() + padded.size()));
  std::fill(text.end() - static_cast<std::ptrdiff_t>(num_missing), text.end(), '=');
  return text;
}

}  // namespace velamap
