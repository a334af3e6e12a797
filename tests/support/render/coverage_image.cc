#include "tests/support/render/coverage_image.h"

#include <algorithm>
#include <cmath>

#include "importer/geometry/quad.h"

namespace velamap {
namespace {

// Area left of x and right of an edge piece whose x runs evenly from x0 to x1 >= x0, per height.
double AreaUpTo(double x, double x0, double x1) {
  if (x <= x0) return 0.0;
  if (x >= x1) return x - 0.5 * (x0 + x1);
  return 0.5 * (x - x0) * (x - x0) / (x1 - x0);
}

}  // namespace

double SignedArea(const ImageQuad& quad) {
  return 0.5 * Cross(quad[2] - quad[0], quad[3] - quad[1]);
}

CoverageImage::CoverageImage(int width_px, int height_px)
    : changes_(height_px, width_px, CV_32FC2, cv::Scalar::all(0)) {}

void CoverageImage::Add(const ImageQuad& quad, double gray, double alpha) {
  const Box box = BoundingBox(quad);
  if (box.max.y() <= 0 || box.min.y() >= changes_.rows || box.min.x() >= changes_.cols) return;
  const cv::Vec2f weight(static_cast<float>(gray), static_cast<float>(alpha));
  for (std::size_t i = 0; i < quad.size(); ++i) {
    // Upward edges of a clockwise quad are its left ones: the picture changes by + weight there.
    AddEdge(quad[(i + 1) % quad.size()], quad[i], weight);
  }
}

void CoverageImage::AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                            const cv::Vec2f& weight) {
  if (from.y() == to.y()) return;
  const bool down = from.y() < to.y();
  const Eigen::Vector2d& upper = down ? from : to;
  const Eigen::Vector2d& lower = down ? to : from;
  const double slope = (lower.x() - upper.x()) / (lower.y() - upper.y());
  const int first_row = std::max(0, static_cast<int>(std::floor(upper.y())));
  const int end_row = std::min(changes_.rows, static_cast<int>(std::ceil(lower.y())));
  for (int row = first_row; row < end_row; ++row) {
    const double top = std::max<double>(row, upper.y());
    const double bottom = std::min<double>(row + 1, lower.y());
    const double x_top = upper.x() + slope * (top - upper.y());
    const double x_bottom = upper.x() + slope * (bottom - upper.y());
    const double x0 = std::min(x_top, x_bottom), x1 = std::max(x_top, x_bottom);
    const double height = down ? bottom - top : top - bottom;
    const int first = static_cast<int>(std::floor(x0));
    const int end = std::min(changes_.cols, static_cast<int>(std::floor(x1)) + 2);
    cv::Vec2f* changes = changes_.ptr<cv::Vec2f>(row);
    double area = 0.0, before = 0.0;  // AreaUpTo(column), and the cover of the pixel on its left
    for (int column = first; column < end; ++column) {
      const double next_area = AreaUpTo(column + 1, x0, x1);
      const double cover = next_area - area;
      // Left of the picture only the sum matters.
      changes[std::max(0, column)] += weight * static_cast<float>(height * (cover - before));
      area = next_area;
      before = cover;
    }
  }
}

cv::Mat CoverageImage::Resolve() {
  for (int row = 0; row < changes_.rows; ++row) {
    cv::Vec2f* pixels = changes_.ptr<cv::Vec2f>(row);
    cv::Vec2d sum(0, 0);
    for (int column = 0; column < changes_.cols; ++column) {
      sum += cv::Vec2d(pixels[column]);
      pixels[column] = sum;
    }
  }
  return changes_;
}

}  // namespace velamap
