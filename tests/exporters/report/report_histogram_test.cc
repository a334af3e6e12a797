#include "exporters/report/report_histogram.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

int NumValues(const Histogram& histogram) {
  return std::accumulate(histogram.counts.begin(), histogram.counts.end(),
                         histogram.num_below + histogram.num_above);
}

TEST(ReportHistogram, CountsEveryFiniteValueOnceWhateverTheScale) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.7, 1.0);
  for (const double scale : {1e-6, 0.03, 1.0, 470.0, 1e7}) {
    std::vector<double> values;
    for (int i = 0; i < 500; ++i) values.push_back(scale * normal(random));
    const Histogram histogram = MakeHistogram(values);
    EXPECT_EQ(NumValues(histogram), 500);
    EXPECT_GE(histogram.counts.size(), 8u);
    EXPECT_LE(histogram.counts.size(), 32u);
  }
}

TEST(ReportHistogram, BordersAreRound) {
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) values.push_back(0.0131 * i);
  const Histogram histogram = MakeHistogram(values);
  EXPECT_NEAR(histogram.bin_width, 0.05, 1e-12);
  EXPECT_NEAR(std::remainder(histogram.first_border, histogram.bin_width), 0, 1e-12);
}

TEST(ReportHistogram, PutsValuesWhereTheyBelong) {
  const Histogram histogram = MakeHistogram({0, 1, 1, 2, 29.5});
  // The last is more than six sigmas (1.48 each) from the median.
  EXPECT_EQ(histogram.num_above, 1);
  EXPECT_EQ(histogram.num_below, 0);
  EXPECT_EQ(histogram.first_border, 0);
  EXPECT_EQ(histogram.counts.front(), 1);
  EXPECT_EQ(histogram.counts.back(), 1);
  EXPECT_EQ(NumValues(histogram), 5);
}

TEST(ReportHistogram, AStrayDoesNotSqueezeTheRest) {
  std::mt19937 random(5);
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) values.push_back(random() / 4294967296.0);
  values.push_back(-1e6);
  values.push_back(1e6);
  const Histogram histogram = MakeHistogram(values);
  EXPECT_EQ(histogram.num_below, 1);
  EXPECT_EQ(histogram.num_above, 1);
  EXPECT_GE(histogram.counts.size(), 15u);
}

TEST(ReportHistogram, EqualValuesGetOneBin) {
  EXPECT_THAT(MakeHistogram({0.0, 0.0, 0.0}).counts, ElementsAre(3));
  EXPECT_EQ(NumValues(MakeHistogram({7e5, 7e5})), 2);
}

TEST(ReportHistogram, LeavesOutWhatIsNotFinite) {
  const double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(NumValues(MakeHistogram({1, 2, kInfinity, std::nan("")})), 2);
  EXPECT_THAT(MakeHistogram({kInfinity}).counts, IsEmpty());
  EXPECT_THAT(MakeHistogram({}).counts, IsEmpty());
}

}  // namespace
}  // namespace velamap
