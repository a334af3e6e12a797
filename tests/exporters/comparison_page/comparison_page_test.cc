// The page of a comparison without a browser (tests/workflows/interop/comparison_browser_test.cc
// has one).

#include "exporters/comparison_page/comparison_page.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "exporters/comparison_page/comparison_words.h"
#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_frame.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/exporters/comparison_page/page_example.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

TEST(ComparisonPage, AShapeAgainstItselfIsTheSame) {
  PageExample example;
  example.Add("again", Moved(FarPose(), BoatShape(0.001)));
  const Json data = example.Data();
  EXPECT_EQ(data["verdict"]["text"], "The shapes are the same.");
  for (const Json& row : data["numbers"]) {
    EXPECT_EQ(row["values"][0]["is_significant"], false);
    EXPECT_NEAR(row["values"][0]["difference"].get<double>(), 0.0, 1e-5);
  }
  for (const Json& marker : data["markers"]) {
    EXPECT_EQ(marker["distances"][0]["distance_mm"], 0.0) << marker["id"];
  }
  for (const Json& distance : data["surfaces"][0]["distances_mm"]) EXPECT_EQ(distance, 0.0);
  EXPECT_EQ(data["profiles"].size(), 5u);
  for (const Json& profile : data["profiles"]) {
    const Json &reference = profile["curves"][0]["own"], &shape = profile["curves"][1]["own"];
    ASSERT_EQ(reference.size(), shape.size());
    for (std::size_t i = 0; i < shape.size(); ++i) {
      EXPECT_NEAR(shape[i][0].get<double>(), reference[i][0].get<double>(), 0.011);
      EXPECT_NEAR(shape[i][1].get<double>(), reference[i][1].get<double>(), 0.011);
    }
  }
}

// The luff of the sail leans aft on an upright hull, which the report of the sail shows upright.
TEST(ComparisonPage, UpIsThatOfTheFrameOfTheReference) {
  PageExample example;
  example.reference = Moved(FarPose(), BoatShape(0.001));
  example.Add("trim2", BoatShape(0.001));
  const Json up = example.Data()["frame"]["up"];
  const Eigen::Vector3d up_in_reference(up[0].get<double>(), up[1].get<double>(),
                                        up[2].get<double>());
  const ShapeFrame frame = ChooseFrame(example.reference, example.layout, std::nullopt, {});
  const Eigen::Vector3d up_in_frame = frame.frame_from_shape.rotation * up_in_reference;
  EXPECT_EQ(frame.name, "reference part hull");
  EXPECT_LT((up_in_frame - frame.up_in_frame.value()).norm(), 1e-4);
  EXPECT_LT(up_in_reference.dot(SailUp(example.reference, example.layout).value()), 0.999);
}

TEST(ComparisonPage, TheFirstLineSaysHowMuchAndWhere) {
  PageExample example;
  example.Add("trim2", Fuller());
  const Json data = example.Data();
  const std::string text = data["verdict"]["text"];
  EXPECT_THAT(text, StartsWith("The shapes differ by "));
  EXPECT_THAT(text, HasSubstr(" mm RMS; camber of h3 +"));
  EXPECT_THAT(text, HasSubstr(" % (significant)."));
  EXPECT_THAT(data["verdict"]["items"].dump(), HasSubstr("markers differ significantly"));
  EXPECT_EQ(data["title"], "trim2 against trim1");
  const auto camber = std::find_if(data["numbers"].begin(), data["numbers"].end(), [](auto& row) {
    return row["section"] == "h3" && row["number"] == "camber";
  });
  ASSERT_NE(camber, data["numbers"].end());
  EXPECT_TRUE((*camber)["values"][0]["is_significant"].get<bool>());
  EXPECT_EQ((*camber)["unit"], "%");
}

// Whatever the items call significant keeps the first line from saying that nothing is.
TEST(ComparisonPage, TheFirstLineAgreesWithItsItems) {
  const MarkerShape boat = BoatShape(0.001);
  const auto page_of = [](const PageExample& example) {
    return std::pair(example.Data()["verdict"]["text"].get<std::string>(),
                     example.Data()["verdict"]["items"].dump());
  };
  PageExample within;
  within.Add("trim2", Shifted({33}, 0.0003 * MarkerNormal(*FindWholeMarker(boat, 33)), boat));
  EXPECT_THAT(page_of(within).first, HasSubstr("no difference is significant"));
  EXPECT_THAT(page_of(within).second, HasSubstr("0 of 36 markers differ significantly"));
  EXPECT_THAT(page_of(within).second, Not(HasSubstr("surface of sail differs")));

  // Averages of many markers may be significant where none of them is.
  PageExample surface_only = within;
  for (auto& deflection : surface_only.series[0].deflections.fields.at(0).deflections) {
    deflection->sigma_m = std::abs(deflection->distance_m) / 2.5;
  }
  EXPECT_THAT(page_of(surface_only).first,
              HasSubstr("mm RMS; the surface of sail differs significantly at "));
  EXPECT_THAT(page_of(surface_only).second,
              HasSubstr("The surface of sail differs significantly at "));

  PageExample markers_only = surface_only;
  markers_only.series[0].deviation.num_significant = 3;
  EXPECT_THAT(page_of(markers_only).first,
              HasSubstr("mm RMS; 3 of 36 markers differ significantly."));
  markers_only.series[0].deviation.num_significant = 1;
  EXPECT_THAT(page_of(markers_only).first,
              HasSubstr("mm RMS; 1 of 36 markers differ significantly, as by chance."));

  PageExample number_only = within;
  number_only.series[0].sections.differences.at(3).significance = 2.3;
  EXPECT_THAT(page_of(number_only).first, HasSubstr(" (significant, as by chance)."));
  EXPECT_THAT(page_of(number_only).second,
              HasSubstr("1 of 30 numbers of the sections differ significantly; about 1 would be "
                        "expected by chance: "));
  number_only.series[0].sections.differences.at(3).significance = 9.0;
  EXPECT_THAT(page_of(number_only).first, HasSubstr(" (significant)."));

  // Without sigmas, nothing is called significant or not.
  PageExample unknown = within;
  unknown.series[0] =
      Compare("trim2", Exact(Fuller()), Exact(BoatShape()), BoatLayout(), WithDeflections());
  EXPECT_THAT(page_of(unknown).first, Not(HasSubstr("significant")));
}

TEST(ComparisonPage, SaysFirstThatShapesAreOfDifferentObjects) {
  PageExample example;
  MarkerShape other = BoatShape(0.001);  // each marker where another one was
  for (std::size_t i = 0; i < other.markers.size(); ++i) {
    const ShapeMarker& there = example.reference.markers[7 * i % other.markers.size()];
    other.markers[i].x_in_shape_m = there.x_in_shape_m;
  }
  example.Add("cube", other);
  const Json verdict = example.Data()["verdict"];
  EXPECT_EQ(verdict["level"], "bad");
  EXPECT_THAT(verdict["text"].get<std::string>(),
              StartsWith("The two shapes are not of the same object: "));
  EXPECT_THAT(verdict["items"].dump(), Not(HasSubstr("larger than the reference")));
  std::ostringstream text;
  PrintMetrics(MakeComparisonReport(example.series), text);
  EXPECT_THAT(text.str(), StartsWith("verdict: bad\nverdict_reason: bad; the two shapes are not"));

  // In a series, the others can still be compared.
  example.Add("trim2", Fuller());
  const Json series = example.Data()["verdict"];
  EXPECT_EQ(series["level"], "bad");
  EXPECT_THAT(series["text"].get<std::string>(), HasSubstr("cube is of another object, trim2 "));
  EXPECT_THAT(series["items"].at(0).get<std::string>(),
              StartsWith("cube: the two shapes are not of the same object"));
  PageExample good;
  good.Add("trim2", Fuller());
  EXPECT_EQ(good.Data()["verdict"]["level"], "");
}

TEST(ComparisonPage, AnotherSizeIsToBeChecked) {
  PageExample example;
  MarkerShape larger = BoatShape(0.001);
  for (ShapeMarker& marker : larger.markers) {
    for (auto& x : marker.x_in_shape_m) *x *= 1.25;
  }
  example.Add("trim2", larger);
  const Json verdict = example.Data()["verdict"];
  EXPECT_EQ(verdict["level"], "check");
  EXPECT_THAT(verdict["text"].get<std::string>(), StartsWith("The shapes differ by "));
  EXPECT_THAT(verdict["items"].at(0).get<std::string>(),
              StartsWith("The shape is 1.25 times as large as the reference"));
}

// Two results that differ by what their markers share, such as their size, differ as little by
// their surfaces as by their markers.
TEST(ComparisonPage, SurfacesAreAsUncertainAsTheirMarkers) {
  const MarkerShape boat = BoatShape(0.0002);
  UncertainShape uncertain = WithSigmas(boat);
  auto& covariance = uncertain.covariance;
  covariance.factor.resize(covariance.factor.rows(), 1);
  covariance.signs = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < covariance.point3D_ids.size(); ++i) {
    const CornerId id = CornerFromPoint3DId(covariance.point3D_ids[i]);
    covariance.factor.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) =
        0.004 * *FindMarker(boat, id.marker_id)->x_in_shape_m[static_cast<std::size_t>(id.corner)];
  }
  MarkerShape larger = boat;
  for (ShapeMarker& marker : larger.markers) {
    for (auto& x : marker.x_in_shape_m) *x *= 1.003;
  }
  PageExample example;
  example.series.push_back(
      Compare("again", {larger, covariance}, uncertain, example.layout, WithDeflections()));
  ASSERT_GT(example.series[0].deviation.distance_m.MaxAbs(), 0.001);
  EXPECT_EQ(example.series[0].deviation.num_significant, 0);
  const Json verdict = example.Data()["verdict"];
  EXPECT_THAT(verdict["text"].get<std::string>(), HasSubstr("no difference is significant"));
  EXPECT_THAT(verdict["items"].dump(), Not(HasSubstr("surface of sail differs")));
}

TEST(ComparisonPage, ASeriesHasAColumnForEachShape) {
  PageExample example;
  example.Add("trim2", Fuller());
  example.Add("trim3", Shifted(IdsOf("sail"), {0, 0.02, 0}, BoatShape(0.001)));
  example.Add("trim4", BoatShape(0.001));
  const Json data = example.Data();
  EXPECT_EQ(data["title"], "3 shapes against trim1");
  EXPECT_THAT(data["verdict"]["text"].get<std::string>(),
              HasSubstr("Differences from trim1: trim2 "));
  EXPECT_THAT(data["verdict"]["text"].get<std::string>(), HasSubstr("trim4 none."));
  EXPECT_EQ(data["shapes"].size(), 3u);
  EXPECT_EQ(data["surfaces"].size(), 3u);
  for (const Json& row : data["numbers"]) EXPECT_EQ(row["values"].size(), 3u);
  for (const Json& row : data["profiles"]) EXPECT_EQ(row["curves"].size(), 4u);
  for (const Json& row : data["markers"]) EXPECT_EQ(row["distances"].size(), 3u);
  // One limit for all, so that colours can be compared.
  EXPECT_GE(data["color_limit_mm"].get<double>(), 20.0);
}

TEST(ComparisonPage, ADesignHasSectionsToo) {
  PageExample example;
  example.is_design = true;
  const MeshDistance design(SailMesh(0.0));
  AlignmentOptions none;
  none.method = AlignmentMethod::kNone;
  ComparisonOptions options = WithDeflections();
  options.alignment = none;
  example.series.push_back(Compare("trim2", WithSigmas(Fuller()), design, example.layout, options));
  const Json data = example.Data();
  EXPECT_THAT(data["verdict"]["text"].get<std::string>(),
              StartsWith("The shape differs from the design by"));
  EXPECT_THAT(data["verdict"]["items"].dump(),
              HasSubstr("markers 120 121 122 123 124 125"));  // the hull
  EXPECT_EQ(data["profiles"].size(), 5u);
  EXPECT_EQ(data["numbers"].size(), 30u);
  for (const Json& row : data["numbers"]) {
    const double difference = row["values"][0]["difference"];
    const double sigma = row["values"][0]["sigma"];
    if (row["section"] == "h3" || row["number"] == "twist") continue;
    EXPECT_LT(std::abs(difference), std::max(4 * sigma, 0.02)) << row.dump();
  }
}

TEST(ComparisonPage, SectionsOfSeveralPartsAreNamedByTheirPart) {
  PageExample example;
  example.Add("trim2", Fuller());
  EXPECT_EQ(SectionName(example.series, "sail", "h3"), "h3");
  Section of_jib = example.series[0].sections.of_reference.sections.front();
  of_jib.part = "jib";
  example.series[0].sections.of_reference.sections.push_back(of_jib);
  const Json data = example.Data();
  EXPECT_THAT(data["verdict"]["text"].get<std::string>(), HasSubstr("camber of sail h3 +"));
  EXPECT_THAT(data["verdict"]["items"].dump(), HasSubstr(" of sail h3 +"));
  EXPECT_EQ(data["numbers"][0]["section"], "sail h1");
  EXPECT_EQ(data["profiles"].back()["section"], "jib h1");
}

TEST(ComparisonPage, WithoutALayoutThereAreMarkers) {
  PageExample example;
  example.layout = {};
  example.Add("trim2", Fuller());
  const Json data = example.Data();
  EXPECT_EQ(data["markers"].size(), 36u);
  EXPECT_TRUE(data["surfaces"][0].is_null());
  EXPECT_TRUE(data["profiles"].empty());
}

TEST(ComparisonPage, IsOneFileWithoutScriptsFromNames) {
  PageExample example;
  example.Add("</script><b>{{STYLE}}", Fuller());
  ComparisonPageInput input = example.Input();
  std::ostringstream out;
  WriteComparisonPage(input, out);
  const std::string page = out.str();
  EXPECT_THAT(page, HasSubstr("<h1>&lt;/script&gt;&lt;b&gt;{{STYLE}} against trim1</h1>"));
  EXPECT_THAT(page, Not(HasSubstr("</script><b>")));
  EXPECT_THAT(page, Not(HasSubstr("{{SCRIPT}}")));
  EXPECT_THAT(page, Not(HasSubstr("<script src")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_LT(page.size(), 3'000'000u);
  std::ostringstream again;
  WriteComparisonPage(input, again);
  EXPECT_EQ(again.str(), page);
}

}  // namespace
}  // namespace velamap
