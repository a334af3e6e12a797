// The profiles of the page of a comparison lie where they should.

#include "exporters/comparison_page/comparison_page.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/comparison_page/page_example.h"

namespace velamap {
namespace {

using Json = nlohmann::json;

TEST(ComparisonPage, ProfilesStartAtTheLuffAndLieWhereTheyAre) {
  PageExample example;
  example.Add("trim2", Shifted(IdsOf("sail"), {0, 0.04, 0}, BoatShape(0.001)));
  const Json data = example.Data();
  for (const Json& profile : data["profiles"]) {
    const Json& reference = profile["curves"][0];
    const Json& shape = profile["curves"][1];
    EXPECT_EQ(reference["name"], "trim1");
    EXPECT_EQ(reference["own"], reference["placed"]);
    EXPECT_NEAR(shape["own"][0][1].get<double>(), 0.0, 0.01);
    // The luff has moved by 40 mm, across and along the chord.
    const double x = shape["placed"][0][0], y = shape["placed"][0][1];
    EXPECT_NEAR(std::hypot(x, y), 40.0, 0.05);
    EXPECT_NEAR(shape["own"].back()[0].get<double>(), reference["own"].back()[0].get<double>(),
                0.05);
  }
}

// Compared with the whole reference, the profile of a line without its leech would lie across it.
TEST(ComparisonPage, AShapeWithoutALeechIsDrawnOnTheChordItIsComparedWith) {
  PageExample example;
  const MarkerShape shape = BoatShape(0.001);
  const MarkerLine& line = example.layout.parts.front().horizontal.front();
  example.Add("trim2", shape);
  example.Add("trim3", Without({line.marker_ids.back()}, shape));
  const Json data = example.Data();
  const auto row_of = [&](const std::string& section, const std::string& number) {
    for (const Json& row : data["numbers"]) {
      if (row["section"] == section && row["number"] == number) return row;
    }
    return Json();
  };
  ASSERT_FALSE(row_of(line.name, "chord").is_null());
  EXPECT_FALSE(row_of(line.name, "chord").contains("reference"));
  const Json range = row_of(line.name, "chord")["reference_range"];
  EXPECT_LT(range[0].get<double>(), range[1].get<double>());
  EXPECT_TRUE(row_of("h3", "chord").contains("reference"));
  for (const Json& profile : data["profiles"]) {
    const Json &whole = profile["curves"][1], &cut = profile["curves"][2];
    EXPECT_NEAR(cut["own"][0][0].get<double>(), 0.0, 0.02);
    // The same shape: each point of one curve is near a point of the other.
    for (const Json& point : cut["own"]) {
      double nearest_mm = 1e9;
      for (const Json& other : whole["own"]) {
        nearest_mm = std::min(nearest_mm,
                              std::abs(point[1].get<double>() - other[1].get<double>()) +
                                  0.2 * std::abs(point[0].get<double>() - other[0].get<double>()));
      }
      EXPECT_LT(nearest_mm, 20) << profile["section"];
    }
  }
}

// The frame of a design's sections follows from the markers of each shape: without the luff marker
// of h1 it is another one, and the profiles of the other lines still lie where they did.
TEST(ComparisonPage, ProfilesAgainstADesignLieWhereTheyAreInAllShapes) {
  PageExample example;
  example.is_design = true;
  const MeshDistance design(SailMesh());
  ComparisonOptions options = WithDeflections();
  options.alignment.method = AlignmentMethod::kNone;
  const MarkerShape shape = Fuller();
  MarkerShape without = shape;
  without.markers.erase(without.markers.begin());
  for (const MarkerShape& each : {shape, without}) {
    example.series.push_back(Compare("trim", WithSigmas(each), design, example.layout, options));
  }
  const Rigid3 &first = example.series[0].sections.frame_from_reference,
               &second = example.series[1].sections.frame_from_reference;
  ASSERT_GT((first.translation - second.translation).norm(), 0.1);
  const Json data = example.Data();
  for (const Json& profile : data["profiles"]) {
    ASSERT_EQ(profile["curves"].size(), 3u);
    if (profile["section"] == "h1") continue;
    const Json &a = profile["curves"][1]["placed"], &b = profile["curves"][2]["placed"];
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i][0].get<double>(), b[i][0].get<double>(), 0.5) << profile["section"];
      EXPECT_NEAR(a[i][1].get<double>(), b[i][1].get<double>(), 0.5) << profile["section"];
    }
  }
}

// Against a design, the reference has only the sections of the shape that it is compared with.
TEST(ComparisonPage, AProfileThatTheFirstShapeLacksIsDrawn) {
  const MeshDistance design(SailMesh());
  ComparisonOptions options;
  options.alignment.method = AlignmentMethod::kNone;
  const MarkerShape whole = Fuller(), holed = Without({32, 33, 34}, Fuller());
  std::vector<std::set<std::string>> curves_of;
  for (const bool whole_first : {true, false}) {
    PageExample example;
    example.is_design = true;
    const auto add = [&](const std::string& name, const MarkerShape& shape) {
      example.series.push_back(Compare(name, WithSigmas(shape), design, example.layout, options));
    };
    if (whole_first) add("whole", whole);
    add("holed", holed);
    if (!whole_first) add("whole", whole);
    const Json data = example.Data();
    std::set<std::string> curves;
    std::vector<std::string> sections;
    for (const Json& profile : data["profiles"]) {
      sections.push_back(profile["section"].get<std::string>());
      for (const Json& curve : profile["curves"]) {
        curves.insert(sections.back() + " " + curve["name"].get<std::string>());
      }
    }
    EXPECT_EQ(sections, (std::vector<std::string>{"h1", "h2", "h3", "h4", "h5"}));
    curves_of.push_back(curves);
  }
  EXPECT_EQ(curves_of[0], curves_of[1]);
  EXPECT_EQ(curves_of[0].count("h3 whole"), 1u);
  EXPECT_EQ(curves_of[0].count("h3 holed"), 0u);
}

}  // namespace
}  // namespace velamap
