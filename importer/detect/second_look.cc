#include "importer/detect/second_look.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "importer/geometry/quad.h"

namespace velamap {
namespace {

cv::Point2f CenterOf(const Outline& outline_px) {
  return (outline_px[0] + outline_px[1] + outline_px[2] + outline_px[3]) / 4;
}

}  // namespace

std::vector<Outline> UnreadOutlines(const std::vector<Outline>& read, std::vector<Outline> rejected,
                                    int num_cells) {
  constexpr double kMaxCellPx = 4.0;
  const double max_perimeter_px = kNumCorners * kMaxCellPx * num_cells;
  std::stable_sort(rejected.begin(), rejected.end(), [](const Outline& a, const Outline& b) {
    return cv::contourArea(a) > cv::contourArea(b);
  });
  std::vector<Outline> unread, known = read;
  for (const Outline& outline_px : rejected) {
    if (cv::arcLength(outline_px, true) > max_perimeter_px) continue;
    const bool is_known = std::any_of(known.begin(), known.end(), [&](const Outline& other) {
      return cv::pointPolygonTest(other, CenterOf(outline_px), false) >= 0;
    });
    if (is_known) continue;
    known.push_back(outline_px);
    unread.push_back(outline_px);
  }
  return unread;
}

cv::Mat EnlargedAndSharpened(const cv::Mat& gray) {
  constexpr double kSigmaPx = 1.2 * kEnlargement, kAmount = 2.0;
  cv::Mat enlarged, blurred;
  cv::resize(gray, enlarged, {}, kEnlargement, kEnlargement, cv::INTER_CUBIC);
  cv::GaussianBlur(enlarged, blurred, {}, kSigmaPx);
  cv::addWeighted(enlarged, 1 + kAmount, blurred, -kAmount, 0, enlarged);
  return enlarged;
}

cv::Point2f InOriginal(const cv::Point2f& enlarged_px) {
  const cv::Point2f half(0.5F, 0.5F);
  return (enlarged_px + half) / kEnlargement - half;
}

}  // namespace velamap
