// shape_exporter on a sail: frame, sections and surface.

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "exporters/formats/shape_csv.h"
#include "importer/text/csv.h"
#include "reconstruct/model/model_io.h"
#include "tests/support/temp_dir.h"
#include "tests/support/true_model.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

// Three lines of six markers of 100 mm.
SyntheticScene MakeSail() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 6;
  options.num_frames = 4;
  return MakeSyntheticScene(options);
}

std::string LayoutText(const Layout& layout) {
  std::string text =
      "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  sail:\n    horizontal:\n";
  for (const MarkerLine& line : layout.parts.front().horizontal) {
    text += fmt::format("      - {{name: {}, markers: [{}]}}\n", line.name,
                        fmt::join(line.marker_ids, ", "));
  }
  return text;
}

class ShapeExporterCommandTest : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteModel(TrueModel(sail_, kOtherUnit_m), path("model"), ModelFormat::kBinary);
    WriteTextFile(dir_ / "layout.yml", LayoutText(sail_.layout));
  }

  ProgramRun Export(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"shape_exporter", "--input_path",     path("model"),
                                          "--layout_path",  path("layout.yml"), "--shape_path",
                                          path("shape")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  }

  void ExpectRefused(const std::vector<std::string>& more, const std::string& part) {
    const ProgramRun run = Export(more);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "shape")) << part;
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  const SyntheticScene sail_ = MakeSail();
  TempDir dir_;
};

TEST_F(ShapeExporterCommandTest, WritesSectionsAndSurfaceInTheFrameOfTheLines) {
  const ProgramRun run = Export({"--Section.heights", "0.1,50"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("frame: lines h1 h3\n"), HasSubstr("sections: 4; camber "),
                    HasSubstr("section_missing: sail height=50: "), HasSubstr("surface: sail; ")));
  EXPECT_THAT(
      ListFolder(path("shape")),
      IsSupersetOf({"sections.csv", "sections.dxf", "sections.json", "section_profiles.csv",
                    "section_profiles.dxf", "section_profiles.svg", "surface.igs", "surface.obj",
                    "surface.ply", "surface.step", "surface.stl", "surface.vts", "surface.msh",
                    "surface_ansys.txt", "surface_edges.csv", "surface_residuals.csv"}));
  const MarkerShape shape = ReadShapeCsv(path("shape/shape.csv"));
  const int luff = sail_.layout.parts.front().horizontal.front().marker_ids.front();
  EXPECT_LT(FindWholeMarker(shape, luff)->x_in_shape_m[0]->norm(), 1e-9);
}

// Ids at the ends of lines that the model lacks stand for leeches that were never seen.
TEST_F(ShapeExporterCommandTest, SaysWhatTwistCountsFrom) {
  Layout layout = sail_.layout;
  std::vector<MarkerLine>& lines = layout.parts.front().horizontal;
  lines[0].marker_ids.push_back(40);
  WriteTextFile(dir_ / "layout.yml", LayoutText(layout));
  EXPECT_THAT(Export().out,
              AllOf(HasSubstr(" %, twist "), HasSubstr("section_note: twist, leech twist, bend and "
                                                       "sag of sail refer to section h2, ")));
  lines[1].marker_ids.push_back(41);
  lines[2].marker_ids.push_back(42);
  WriteTextFile(dir_ / "layout.yml", LayoutText(layout));
  EXPECT_THAT(Export().out, AllOf(HasSubstr(" %, no twist\n"),
                                  HasSubstr("section_note: no twist, leech twist, bend and sag of "
                                            "sail: each of its lines lacks ")));
}

// Every program reads a header and as many fields in each row; the frame is in shape.json.
TEST_F(ShapeExporterCommandTest, TablesAreTidy) {
  const std::vector<MarkerLine>& lines = sail_.layout.parts.front().horizontal;
  std::string layout =
      "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  \"#1\":\n"
      "    horizontal:\n";
  for (int i = 0; i < 2; ++i) {
    layout += fmt::format("      - {{name: {}, markers: [{}]}}\n", lines[i].name,
                          fmt::join(lines[i].marker_ids, ", "));
  }
  layout += fmt::format("  hull: {{markers: [{}]}}\n", fmt::join(lines[2].marker_ids, ", "));
  WriteTextFile(dir_ / "layout.yml", layout);
  const ProgramRun run = Export({"--Section.heights", "0.1,50"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::vector<std::string> tables;
  for (const std::string& name : ListFolder(path("shape"))) {
    if (std::filesystem::path(name).extension() != ".csv") continue;
    tables.push_back(name);
    const std::string text = ReadFileBytes(path("shape/" + name));
    EXPECT_THAT(text.substr(0, text.find('\n')), MatchesRegex("[a-z][a-z_]*(,[a-z0-9_]+)+"))
        << name;
    std::istringstream in(text);
    const std::vector<CsvRecord> records = ReadCsv(in, name);
    EXPECT_GT(records.size(), 1u) << name;
    // None is a comment or empty.
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<int>(records.size())) << name;
    for (const CsvRecord& record : records) {
      EXPECT_EQ(record.fields.size(), records.front().fields.size()) << name << ':' << record.line;
    }
  }
  EXPECT_THAT(tables, UnorderedElementsAre("freeform_residuals.csv", "metrics.csv", "scale.csv",
                                           "section_profiles.csv", "sections.csv", "shape.csv",
                                           "surface_edges.csv", "surface_residuals.csv"));
  const auto json = nlohmann::json::parse(ReadFileBytes(path("shape/shape.json")));
  EXPECT_THAT(json.at("frame").at("name"), StartsWith("lines "));
  EXPECT_TRUE(json.contains("velamap_version"));
  EXPECT_FALSE(json.contains("clip"));  // the model does not say
  EXPECT_EQ(json.at("files").size(), ListFolder(path("shape")).size() - 2);  // itself, .velamap
}

TEST_F(ShapeExporterCommandTest, TheFrameIsTheOneAskedFor) {
  EXPECT_THAT(Export({"--frame", "camera"}).out, HasSubstr("frame: camera\n"));
  const MarkerShape in_camera = ReadShapeCsv(path("shape/shape.csv"));
  for (const ShapeMarker& marker : in_camera.markers) {
    EXPECT_LT((*marker.x_in_shape_m[0] - sail_.x_in_world.at(marker.marker_id)[0]).norm(), 1e-9);
  }
  const std::vector<int>& line = sail_.layout.parts.front().horizontal.back().marker_ids;
  const int foot = sail_.layout.parts.front().horizontal.front().marker_ids.front();
  const std::string ids = fmt::format("{},{},{}", line[3], line[5], foot);
  EXPECT_THAT(Export({"--frame", ids}).out, HasSubstr("frame: markers "));
  const MarkerShape by_markers = ReadShapeCsv(path("shape/shape.csv"));
  const Eigen::Vector3d axis = *FindWholeMarker(by_markers, line[5])->x_in_shape_m[0];
  EXPECT_LT(FindWholeMarker(by_markers, line[3])->x_in_shape_m[0]->norm(), 1e-9);
  EXPECT_GT(axis.x(), 0);
  EXPECT_LT(axis.tail<2>().norm(), 1e-9);
}

TEST_F(ShapeExporterCommandTest, KnownPointsGiveTheirFrameAndPassOrFailChecks) {
  const Rigid3 known_from_world{Eigen::Quaterniond(0.5, -0.2, 0.8, 0.1).normalized(), {7, -3, 2}};
  const std::vector<int>& foot = sail_.layout.parts.front().horizontal.front().marker_ids;
  const std::vector<int>& head = sail_.layout.parts.front().horizontal.back().marker_ids;
  std::string layout = LayoutText(sail_.layout) + "known_points:\n";
  for (const int id : {foot[0], foot[5], head[0], head[4], foot[2], head[2]}) {
    Eigen::Vector3d x = known_from_world * sail_.x_in_world.at(id)[0];
    const bool is_check = id == foot[2] || id == head[2];
    if (id == head[2]) x.z() += 0.01;
    layout += fmt::format("  - {{at: {}, x: {}, y: {}, z: {}, sigma: 0.002{}}}\n", id, x.x(), x.y(),
                          x.z(), is_check ? ", use: check" : "");
  }
  WriteTextFile(dir_ / "layout.yml", layout);
  const ProgramRun run = Export();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(fmt::format("frame: known points {} {} {} {}\n", foot[0], foot[5],
                                             head[0], head[4])));
  EXPECT_THAT(run.out, AllOf(HasSubstr("known_points: 4 of 4 used"),
                             HasSubstr("1 of 2 checks passed"), HasSubstr("verdict: bad")));
  EXPECT_THAT(run.err, HasSubstr(fmt::format("check point {} is 10.0 mm", head[2])));
  EXPECT_THAT(ReadFileBytes(path("shape/metrics.json")),
              AllOf(HasSubstr("\"known_points\""), HasSubstr("\"fail\"")));
  const auto verdict = nlohmann::json::parse(ReadFileBytes(path("shape/shape.json"))).at("verdict");
  EXPECT_EQ(verdict.at("level"), "bad");
  for (const auto& reason : verdict.at("reasons")) {
    EXPECT_THAT(run.out, HasSubstr(fmt::format("verdict_reason: {}; {}\n",
                                               reason.at("level").get<std::string>(),
                                               reason.at("text").get<std::string>())));
  }
  for (const ShapeMarker& marker : ReadShapeCsv(path("shape/shape.csv")).markers) {
    const Eigen::Vector3d expected = known_from_world * sail_.x_in_world.at(marker.marker_id)[0];
    EXPECT_LT((*marker.x_in_shape_m[0] - expected).norm(), 1e-9);
  }
  EXPECT_THAT(Export({"--frame", "lines"}).out,
              AllOf(HasSubstr("frame: lines "), HasSubstr("known_points: 4 of 4 used")));
}

TEST_F(ShapeExporterCommandTest, ALayoutWithoutLinesIsSaidOnce) {
  WriteTextFile(
      dir_ / "layout.yml",
      "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  board: {markers: [0, 1, 2]}\n");
  const ProgramRun run = Export();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              HasSubstr("section_note: no sections: the layout has no horizontal lines\n"));
  EXPECT_THAT(run.out, Not(HasSubstr("\nsurface")));
  EXPECT_THAT(ListFolder(path("shape")),
              UnorderedElementsAre(".velamap", "shape.csv", "shape.ply", "markers.ply", "scale.csv",
                                   "metrics.csv", "metrics.json", "shape.json"));
}

TEST_F(ShapeExporterCommandTest, SurfaceGoesOnToGivenEdges) {
  const auto area = [&](const std::vector<std::string>& more) {
    const ProgramRun run = Export(more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const std::size_t start = run.out.find("surface: sail; ");
    EXPECT_NE(start, std::string::npos) << run.out;
    return std::stod(run.out.substr(start + 15));
  };
  const double alone = area({});
  EXPECT_GT(area({"--Surface.foot_extension", "100"}), 1.02 * alone);
  WriteTextFile(dir_ / "edges.csv", "edge,x,y,z\nfoot,0,0,-0.2\nfoot,0.5,0,-0.2\nfoot,1,0,-0.2\n");
  EXPECT_GT(area({"--Surface.edges_path", path("edges.csv")}), 1.02 * alone);
}

// The limits of these options follow from the shape, which is written all the same, but not shown
// as a success.
TEST_F(ShapeExporterCommandTest, ShapeIsWrittenWhateverBecomesOfTheSurface) {
  const auto expect_error = [&](const std::vector<std::string>& more, const std::string& part) {
    const ProgramRun run = Export(more);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_THAT(run.err, HasSubstr("everything but the surface is written"));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(ListFolder(path("shape")), IsSupersetOf({"shape.csv", "sections.csv"}));
    std::filesystem::remove_all(path("shape"));
  };
  expect_error({"--Surface.edge_length", "0.001"}, "triangles");
  expect_error({"--Surface.luff_extension", "1e6", "--Surface.head_extension", "1e6"},
               "--Surface.luff_extension: 1e+06 mm, expected at most");
  std::filesystem::create_directory(path("shape"));  // an empty folder holds no earlier result
  expect_error({"--Surface.edge_length", "0.001"}, "triangles");
}

TEST_F(ShapeExporterCommandTest, AWrongSurfaceOptionKeepsTheEarlierResult) {
  const std::vector<std::string> model = {"--output_path", path("metric")};
  const ProgramRun first = Export(model);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const auto files = [&] {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(dir_.path())) {
      if (entry.is_regular_file()) bytes[entry.path()] = ReadFileBytes(entry.path());
    }
    return bytes;
  };
  const std::map<std::string, std::string> before = files();
  EXPECT_EQ(before.count(path("shape/surface.step")), 1u);
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--Surface.luff_extension", "1e6"},
        std::vector<std::string>{"--Surface.edge_length", "0.001"}}) {
    std::vector<std::string> more = model;
    more.insert(more.end(), option.begin(), option.end());
    const ProgramRun run = Export(more);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: " + option[0]));
    EXPECT_THAT(run.err, HasSubstr("the earlier result stays as it was"));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(files(), before) << option[0];
  }
}

TEST_F(ShapeExporterCommandTest, BadOptionsWriteNothing) {
  ExpectRefused({"--frame", "keel"}, "--frame");
  ExpectRefused({"--Section.heights", "1,x"}, "--Section.heights: '1,x'");
  ExpectRefused({"--Section.min_markers", "2"}, "--Section.min_markers: 2 is out of range");
  ExpectRefused({"--Surface.edge_length", "0"}, "edge");
  ExpectRefused({"--Surface.edge_length", "10", "--Surface.chord_deviation", "1"}, "chord");
  ExpectRefused({"--Surface.luff_extension", "-1"}, "luff");
  ExpectRefused({"--Surface.edges_path", path("no.csv")}, "no.csv");
  WriteTextFile(dir_ / "edges.csv", "edge,x,y,z\nkeel,0,0,0\n");
  ExpectRefused({"--Surface.edges_path", path("edges.csv")}, "edges.csv:2: column edge");
}

}  // namespace
}  // namespace velamap
