#include "importer/video/interlacing.h"

#include <algorithm>
#include <cstdint>

namespace velamap {
namespace {

constexpr int kMinDifference = 30;  // levels; above the noise of cameras
constexpr int kRowStep = 7;         // odd, so that both fields are looked at
constexpr double kMinFieldRatio = 1.5, kMinFieldShare = 0.0003;

// Number of pixels of a line that are brighter, or darker, than both other lines.
int CountBeyond(const std::uint8_t* line, const std::uint8_t* above, const std::uint8_t* below,
                int num_pixels) {
  int count = 0;
  for (int x = 0; x < num_pixels; ++x) {
    const int to_above = line[x] - above[x], to_below = line[x] - below[x];
    count += (to_above > kMinDifference && to_below > kMinDifference) ||
             (to_above < -kMinDifference && to_below < -kMinDifference);
  }
  return count;
}

}  // namespace

bool IsCombed(const cv::Mat& gray) {
  double num_of_other_field = 0, num_of_same_field = 0, num_of_columns = 0, num_pixels = 0;
  for (int y = 2; y + 2 < gray.rows; y += kRowStep) {
    const auto* line = gray.ptr(y);
    num_of_other_field += CountBeyond(line, gray.ptr(y - 1), gray.ptr(y + 1), gray.cols);
    num_of_same_field += CountBeyond(line, gray.ptr(y - 2), gray.ptr(y + 2), gray.cols);
    num_of_columns += CountBeyond(line + 1, line, line + 2, gray.cols - 2);
    num_pixels += gray.cols;
  }
  return num_of_other_field > kMinFieldShare * num_pixels &&
         num_of_other_field > kMinFieldRatio * std::max(num_of_same_field, num_of_columns);
}

}  // namespace velamap
