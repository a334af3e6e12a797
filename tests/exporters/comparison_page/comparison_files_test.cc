// What a comparison writes beside its page, and the names of its shapes.

#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/comparison_page/comparison_words.h"
#include "tests/exporters/comparison_page/page_example.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ComparisonFiles, APartKeepsItsNumberWhereAnotherHasNoSurface) {
  PageExample example;
  example.layout = WithJib(BoatLayout());
  example.reference = WithJib(BoatShape(0.001));
  example.Add("both", example.reference);
  example.Add("jib", Without(IdsOf("sail"), example.reference));
  const TempDir dir;
  WriteComparisonFiles(example.Input(), dir.path());
  EXPECT_TRUE(std::filesystem::exists(dir / "deflection_both.vts"));
  EXPECT_TRUE(std::filesystem::exists(dir / "deflection_both_part2.vts"));
  EXPECT_FALSE(std::filesystem::exists(dir / "deflection_jib.vts"));
  EXPECT_TRUE(std::filesystem::exists(dir / "deflection_jib_part2.vts"));
}

TEST(ComparisonSeries, FiguresNameTheirShape) {
  PageExample example;
  example.Add("trim2", Fuller());
  const MetricsReport one = MakeComparisonReport(example.series);
  EXPECT_EQ(one.metrics.front().key, "alignment");
  example.Add("trim3", BoatShape(0.001));
  const MetricsReport two = MakeComparisonReport(example.series);
  EXPECT_TRUE(two.metrics.empty());
  EXPECT_EQ(two.tables.front().name, "shapes");
  EXPECT_EQ(two.tables.size(), one.tables.size() + 1);
  for (const MetricTable& table : two.tables) {
    for (const Metrics& row : table.rows) EXPECT_EQ(row.front().key, "shape") << table.name;
  }
  std::ostringstream text;
  PrintMetrics(two, text);
  EXPECT_THAT(text.str(), HasSubstr("shapes: shape trim2, alignment reference_part"));
  EXPECT_THAT(text.str(), HasSubstr("section_differences: shape trim3, part sail, section h1"));
}

TEST(ComparisonSeries, ShapesAreNamedByTheirFolders) {
  EXPECT_THAT(NamesOfShapes({"/a/trim1/shape", "/a/trim2/shape/", "/a/trim3/shape/shape.csv",
                             "/a/truth.csv", "/b/trim1/shape", "/b/trim1"}),
              ElementsAre("trim1", "trim2", "trim3", "truth.csv", "trim1 (2)", "trim1 (3)"));
}

}  // namespace
}  // namespace velamap
