#include "exporters/sail/section_writer.h"

#include <algorithm>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "exporters/sail/section_drawing.h"
#include "importer/text/csv.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/sail/sail_shapes.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct Example {
  ShapeFrame frame;
  SectionReport report;
};

// Three lines, a height, one line missing.
Example MakeExample() {
  Sail sail = ExampleSail();
  SetSigma(0.002, &sail.shape);
  sail.layout.parts[0].horizontal.push_back({"h4, \"top\" <5>", {990, 991, 992}});
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  return {frame, ComputeSections(sail.shape, frame, sail.layout, nullptr, {{1.0}})};
}

using CsvTable = void(const SectionReport&, std::ostream&);
std::string Written(CsvTable* write, const Example& example) {
  std::ostringstream out;
  write(example.report, out);
  return out.str();
}

using FrameWriter = void(const SectionReport&, const ShapeFrame&, std::ostream&);
std::string Written(FrameWriter* write, const Example& example) {
  std::ostringstream out;
  write(example.report, example.frame, out);
  return out.str();
}

using DxfWriter = void(const SectionReport&, const ShapeFrame&, LengthUnit, std::ostream&);
std::string Dxf(const Example& example, LengthUnit unit = LengthUnit::kMetre,
                DxfWriter* write = WriteSectionsDxf) {
  std::ostringstream out;
  write(example.report, example.frame, unit, out);
  return out.str();
}

std::vector<std::map<std::string, std::string>> Rows(const std::string& csv) {
  std::istringstream in(csv);
  const std::vector<CsvRecord> records = ReadCsv(in, "test");
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < records.size(); ++i) {
    EXPECT_EQ(records[i].fields.size(), records[0].fields.size());
    rows.emplace_back();
    for (std::size_t k = 0; k < records[0].fields.size(); ++k) {
      rows.back()[records[0].fields[k]] = records[i].fields[k];
    }
  }
  return rows;
}

TEST(SectionWriter, CsvHasAHeaderAndARowASection) {
  const Example example = MakeExample();
  const std::string csv = Written(WriteSectionsCsv, example);
  EXPECT_THAT(csv, StartsWith("part,section,height_m,num_markers,chord_m,sigma_chord_m,"));
  const auto rows = Rows(csv);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].at("section"), "h1");
  EXPECT_EQ(rows[0].at("num_markers"), "12");
  EXPECT_EQ(std::stod(rows[0].at("camber")), example.report.sections[0].camber.value);
  EXPECT_EQ(std::stod(rows[3].at("sigma_twist_deg")), *example.report.sections[3].twist_deg->sigma);
  EXPECT_EQ(rows[1].at("section"), "height=1");
  EXPECT_EQ(rows[1].at("num_markers"), "");
  EXPECT_EQ(rows[4].at("section"), "h4, \"top\" <5>");
  EXPECT_EQ(rows[4].at("chord_m"), "");
  EXPECT_THAT(rows[4].at("reason"), HasSubstr("the layout gives it 3 markers"));
}

TEST(SectionWriter, JsonHasTheSameNumbersAsTheCsv) {
  const Example example = MakeExample();
  const auto rows = Rows(Written(WriteSectionsCsv, example));
  const auto json = nlohmann::json::parse(Written(WriteSectionsJson, example));
  EXPECT_EQ(json["frame"]["name"], "lines h1 v1");
  EXPECT_EQ(json["rigs"][0]["twist_reference"], "lowest section");
  EXPECT_EQ(json["rigs"][0]["reference_section"], "h1");
  ASSERT_EQ(json["sections"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (const char* key : {"chord_m", "camber", "draft_position", "entry_angle_deg",
                            "exit_angle_deg", "twist_deg", "height_m", "sigma_camber"}) {
      EXPECT_EQ(json["sections"][i][key].get<double>(), std::stod(rows[i].at(key))) << key;
    }
  }
  EXPECT_EQ(json["sections"][0]["markers"].size(), 12u);
  EXPECT_EQ(json["missing"][0]["section"], "h4, \"top\" <5>");
}

TEST(SectionWriter, ATwistThatIsUnknownIsLeftOut) {
  Sail sail = ExampleSail();
  for (const int id : {111, 211, 311}) RemoveMarker(id, &sail.shape);
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  const Example example{frame, ComputeSections(sail.shape, frame, sail.layout, nullptr)};
  const auto rows = Rows(Written(WriteSectionsCsv, example));
  const auto json = nlohmann::json::parse(Written(WriteSectionsJson, example));
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const char* key : {"twist_deg", "leech_twist_deg"}) {
      EXPECT_EQ(rows[i].at(key), "");
      EXPECT_FALSE(json["sections"][i].contains(key));
    }
  }
  EXPECT_EQ(json["rigs"][0]["twist_reference"], "none");
  EXPECT_FALSE(json["rigs"][0].contains("reference_section"));
  EXPECT_THAT(json["notes"][0], HasSubstr("no twist, "));
  const std::string svg = Written(WriteSectionProfilesSvg, example);
  EXPECT_THAT(svg, HasSubstr(">no twist</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("against none")));
}

TEST(SectionWriter, ProfilesBeginAtTheLuffAndEndAtTheLeech) {
  const Example example = MakeExample();
  const std::string csv = Written(WriteSectionProfilesCsv, example);
  EXPECT_THAT(csv, StartsWith("part,section,marker_id,x,y,z,chordwise_mm,depth_mm\n"));
  const auto rows = Rows(csv);
  ASSERT_EQ(rows.size(), 4 * kNumProfilePoints + 3 * 12u);
  EXPECT_EQ(std::stod(rows[0].at("chordwise_mm")), 0);
  EXPECT_NEAR(std::stod(rows[kNumProfilePoints - 1].at("chordwise_mm")),
              1e3 * example.report.sections[0].chord_m.value, 1e-9);
  EXPECT_NEAR(std::stod(rows[kNumProfilePoints - 1].at("depth_mm")), 0, 1e-9);
  EXPECT_NEAR(std::stod(rows[kNumProfilePoints / 2].at("depth_mm")), 240, 3);
  EXPECT_EQ(rows[kNumProfilePoints].at("marker_id"), "100");
}

TEST(SectionWriter, LocaleDoesNotMatter) {
  const Example example = MakeExample();
  const auto all = [&] {
    return Written(WriteSectionsCsv, example) + Written(WriteSectionsJson, example) +
           Written(WriteSectionProfilesCsv, example) + Dxf(example) +
           Dxf(example, LengthUnit::kMetre, WriteSectionProfilesDxf) +
           Written(WriteSectionProfilesSvg, example);
  };
  const std::string classic = all();
  const CommaLocale comma_locale;
  EXPECT_EQ(all(), classic);
}

TEST(SectionWriter, NothingToWriteIsStillAFileThatSaysWhy) {
  Sail sail = ExampleSail();
  sail.layout.parts.clear();
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  const Example example{frame, ComputeSections(sail.shape, frame, sail.layout, nullptr)};
  const std::string csv = Written(WriteSectionsCsv, example);
  EXPECT_THAT(csv, StartsWith("part,section,"));
  EXPECT_TRUE(Rows(csv).empty());
  const auto notes = nlohmann::json::parse(Written(WriteSectionsJson, example))["notes"];
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], StartsWith("no sections: the layout has no"));
  EXPECT_THAT(Dxf(example), HasSubstr("EOF\n"));
  EXPECT_THAT(Written(WriteSectionProfilesSvg, example), HasSubstr("no sections: the layout"));
}

// Group codes and values of a DXF file.
std::vector<std::pair<int, std::string>> ReadDxf(const std::string& text) {
  std::vector<std::pair<int, std::string>> groups;
  std::istringstream in(text);
  std::string code, value;
  while (std::getline(in, code) && std::getline(in, value))
    groups.emplace_back(std::stoi(code), value);
  return groups;
}

// Checks a DXF against the sections in its unit.
void ExpectSections(const Example& example, const std::string& dxf, double units_per_m,
                    const std::string& unit_code) {
  const auto groups = ReadDxf(dxf);
  EXPECT_EQ(groups.front().first, 999);
  EXPECT_EQ(groups.back(), std::make_pair(0, std::string("EOF")));
  std::map<std::string, std::vector<Eigen::Vector3d>> vertices;
  std::string entity, layer, variable, units;
  int num_points = 0;
  for (const auto& [code, value] : groups) {
    if (code == 9) variable = value;
    if (code == 70 && variable == "$INSUNITS" && units.empty()) units = value;
    if (code == 0) {
      entity = value;
      num_points += entity == "POINT";
    }
    if (code == 8) layer = value;
    if (entity != "VERTEX") continue;
    if (code == 10) vertices[layer].push_back({std::stod(value), 0, 0});
    if (code == 20) vertices[layer].back().y() = std::stod(value);
    if (code == 30) vertices[layer].back().z() = std::stod(value);
  }
  EXPECT_EQ(num_points, 36);
  EXPECT_EQ(units, unit_code);
  ASSERT_EQ(vertices.size(), 4u);
  ASSERT_EQ(vertices.count("SAIL_H3"), 1u);
  ASSERT_EQ(vertices.count("SAIL_HEIGHT_1"), 1u);
  for (const Section& section : example.report.sections) {
    if (section.name != "h3") continue;
    const auto profile = SampleProfile(section, kNumProfilePoints);
    ASSERT_EQ(vertices["SAIL_H3"].size(), profile.size());
    for (std::size_t i = 0; i < profile.size(); ++i) {
      EXPECT_LT((vertices["SAIL_H3"][i] / units_per_m - profile[i].x_in_frame_m).norm(), 1.1e-7);
    }
  }
}

TEST(SectionDrawing, DxfHasEverySectionInItsUnitOnALayerOfItsOwn) {
  const Example example = MakeExample();
  const std::string in_m = Dxf(example), in_mm = Dxf(example, LengthUnit::kMillimetre);
  EXPECT_THAT(in_m, HasSubstr("unit m, frame lines h1 v1"));
  EXPECT_THAT(in_mm, HasSubstr("unit mm, frame lines h1 v1"));
  ExpectSections(example, in_m, 1, "6");
  ExpectSections(example, in_mm, 1e3, "4");
}

// R12 knows no UTF-8.
TEST(SectionDrawing, DxfIsAscii) {
  Example example = MakeExample();
  example.frame.description = "h\xC3\xB6he";
  example.report.sections[0].name = "gro\xC3\x9F";
  for (DxfWriter* write : {WriteSectionsDxf, WriteSectionProfilesDxf}) {
    const std::string dxf = Dxf(example, LengthUnit::kMetre, write);
    EXPECT_TRUE(std::all_of(dxf.begin(), dxf.end(), [](unsigned char c) { return c < 128; }));
    EXPECT_THAT(dxf, HasSubstr("h__he"));
  }
  EXPECT_THAT(Dxf(example, LengthUnit::kMetre, WriteSectionProfilesDxf), HasSubstr("sail gro__"));
}

TEST(SectionDrawing, SvgIsWellFormedToOneScaleAndHasTheNumbers) {
  const Example example = MakeExample();
  const std::string svg = Written(WriteSectionProfilesSvg, example);
  EXPECT_THAT(svg, HasSubstr("&lt;5&gt; left out"));
  EXPECT_THAT(svg, HasSubstr("camber 8.0"));
  EXPECT_THAT(svg, HasSubstr("twist 1"));
  EXPECT_THAT(svg, HasSubstr("twist of sail against lowest section"));
  EXPECT_THAT(svg, HasSubstr("frame lines h1 v1"));
  // The longest chord fills the width; the others are in proportion, whatever the axis.
  std::vector<double> lengths_px;
  std::size_t at = 0;
  while ((at = svg.find("class=\"chord\" x1=\"", at)) != std::string::npos) {
    const auto number = [&](const std::string& key) {
      return std::stod(svg.substr(svg.find(key + "=\"", at) + key.size() + 2));
    };
    lengths_px.push_back(number("x2") - number("x1"));
    ++at;
  }
  ASSERT_EQ(lengths_px.size(), 4u);
  // The ratio of the head, which is drawn on top but written last, to the foot.
  EXPECT_NEAR(lengths_px[3] / lengths_px[0],
              example.report.sections[3].chord_m.value / example.report.sections[0].chord_m.value,
              1e-4);
}

TEST(SectionDrawing, SvgRoundsNoSigmaToZero) {
  Example example = MakeExample();
  for (Section& section : example.report.sections) {
    section.camber.sigma = 2e-5;
    section.entry_angle_deg.sigma = 0.004;
  }
  const std::string svg = Written(WriteSectionProfilesSvg, example);
  EXPECT_THAT(svg, HasSubstr(" ± 0.002 %"));
  EXPECT_THAT(svg, HasSubstr(" ± 0.004°"));
  EXPECT_THAT(svg, Not(HasSubstr("± 0.0°")));
}

}  // namespace
}  // namespace velamap
