#include "exporters/scale/scale_csv.h"

#include <gtest/gtest.h>

#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

ScaleEstimate Example() {
  ScaleEstimate scale;
  scale.m_per_unit = 2.0;
  scale.m_per_unit_of = {{0, 2.5}, {7, 2.0}, {1200, 1.999}};
  return scale;
}

std::string WrittenScale() {
  return Written([](std::ostream& out) { WriteScaleCsv(Example(), out); });
}

TEST(ScaleCsv, GivesEachMarkerItsDeviation) {
  const std::string deviation = "-0.0004999999999999449";  // 1.999 / 2 - 1 in doubles
  EXPECT_EQ(
      WrittenScale(),
      "marker_id,m_per_unit,relative_deviation\n0,2.5,0.25\n7,2,0\n1200,1.999," + deviation + "\n");
}

TEST(ScaleCsv, IsTheSameInAnyLocale) {
  const std::string expected = WrittenScale();
  const CommaLocale locale;
  EXPECT_EQ(WrittenScale(), expected);
}

}  // namespace
}  // namespace velamap
