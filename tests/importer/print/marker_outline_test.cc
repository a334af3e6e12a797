#include "importer/print/marker_outline.h"

#include <random>

#include <gtest/gtest.h>

#include "importer/layout/dictionary.h"

namespace velamap {
namespace {

using Outlines = std::vector<std::vector<Eigen::Vector2d>>;

// Positive for clockwise outlines as seen, y being down.
double SignedArea(const std::vector<Eigen::Vector2d>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

// How often the outlines go around a point.
int Winding(const Outlines& outlines, const Eigen::Vector2d& point) {
  int winding = 0;
  for (const auto& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d& a = outline[i];
      const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
      if (a.x() != b.x() || a.x() < point.x()) continue;  // upright sides on the right
      if (a.y() < point.y() && b.y() > point.y()) ++winding;
      if (a.y() > point.y() && b.y() < point.y()) --winding;
    }
  }
  return winding;
}

void ExpectOutlines(const cv::Mat& cells) {
  const Outlines outlines = OutlineDarkCells(cells);
  double area = 0;
  for (const auto& outline : outlines) {
    area += SignedArea(outline);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d side = outline[(i + 1) % outline.size()] - outline[i];
      const Eigen::Vector2d next =
          outline[(i + 2) % outline.size()] - outline[(i + 1) % outline.size()];
      EXPECT_EQ(side.dot(next), 0) << "a corner on a straight side";
    }
  }
  EXPECT_EQ(area, static_cast<double>(cells.total()) - cv::countNonZero(cells));
  for (int y = 0; y < cells.rows; ++y) {
    for (int x = 0; x < cells.cols; ++x) {
      EXPECT_EQ(Winding(outlines, {x + 0.5, y + 0.5}), cells.at<std::uint8_t>(y, x) == 0)
          << x << ' ' << y;
    }
  }
}

TEST(OutlineDarkCells, SurroundsExactlyTheDarkCells) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    cv::Mat_<std::uint8_t> cells(1 + i % 7, 1 + i % 9);
    for (std::uint8_t& cell : cells) cell = random() % 2 != 0 ? 255 : 0;
    ExpectOutlines(cells);
  }
}

TEST(OutlineDarkCells, MarkersHaveOneOuterOutline) {
  const Dictionary dictionary = LoadDictionary("DICT_6X6_250");
  for (int id = 0; id < 250; ++id) {
    const cv::Mat cells = MarkerCells(dictionary, id, 1);
    ExpectOutlines(cells);
    int num_large = 0;
    for (const auto& outline : OutlineDarkCells(cells)) num_large += SignedArea(outline) == 64;
    EXPECT_EQ(num_large, 1) << id;
  }
}

TEST(OutlineDarkCells, NothingDarkGivesNothing) {
  EXPECT_TRUE(OutlineDarkCells(cv::Mat(3, 3, CV_8UC1, cv::Scalar(255))).empty());
  EXPECT_EQ(OutlineDarkCells(cv::Mat(3, 3, CV_8UC1, cv::Scalar(0))).size(), 1u);
}

}  // namespace
}  // namespace velamap
