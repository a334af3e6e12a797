#include "importer/layout/layout.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;

constexpr char kSail[] = R"(dictionary: DICT_4X4_100
marker_length: 0.100
marker_lengths: {200: 0.050}
border_bits: 2
parts:
  sail:
    horizontal:
      - {name: h1, markers: [1, 2, 3]}
      - {name: h2, markers: [11, 12, 13]}
    vertical:
      - {name: v1, markers: [2, 12, 22]}
    markers: [90, 91]
  hull: {markers: [120, 121, 122], rigid: true}
reference_part: hull
distances:
  - {from: 1, to: 120, length: 2.315, sigma: 0.002}
  - {from: "3.1", to: 3.3, length: 0.1414, sigma: 0.0001, use: scale}
  - {from: 2, to: 2.4, length: 0.0707, sigma: 1e-4, use: check}
)";

std::string WriteLayout(const TempDir& dir, const std::string& text) {
  const std::string path = dir / "layout.yml";
  std::ofstream(path) << text;
  return path;
}

TEST(ReadLayout, ReadsEveryKey) {
  const TempDir dir;
  const Layout layout = ReadLayout(WriteLayout(dir, kSail));
  EXPECT_EQ(layout.dictionary, "DICT_4X4_100");
  EXPECT_EQ(MarkerLength(layout, 1), 0.1);
  EXPECT_EQ(MarkerLength(layout, 200), 0.05);
  EXPECT_EQ(layout.border_bits, 2);
  EXPECT_EQ(layout.reference_part, "hull");
  ASSERT_EQ(layout.parts.size(), 2u);
  EXPECT_EQ(layout.parts[0].name, "sail");
  EXPECT_FALSE(layout.parts[0].rigid);
  EXPECT_TRUE(layout.parts[1].rigid);
  ASSERT_EQ(layout.parts[0].horizontal.size(), 2u);
  EXPECT_EQ(layout.parts[0].horizontal[1].name, "h2");
  EXPECT_THAT(layout.parts[0].horizontal[1].marker_ids, ElementsAre(11, 12, 13));
  EXPECT_THAT(layout.parts[0].vertical.at(0).marker_ids, ElementsAre(2, 12, 22));
  EXPECT_THAT(MarkerIds(layout), ElementsAre(1, 2, 3, 11, 12, 13, 22, 90, 91, 120, 121, 122));
  EXPECT_EQ(PartOfMarker(layout, 22), "sail");
  EXPECT_EQ(PartOfMarker(layout, 121), "hull");
  EXPECT_EQ(PartOfMarker(layout, 7), "");
  ASSERT_EQ(layout.distances.size(), 3u);
  const KnownDistance& bar = layout.distances[1];
  EXPECT_THAT((std::vector<int>{bar.marker_id1, bar.corner1, bar.marker_id2, bar.corner2}),
              ElementsAre(3, 1, 3, 3));
  EXPECT_EQ(bar.length_m, 0.1414);
  EXPECT_EQ(bar.sigma_m, 0.0001);
  EXPECT_TRUE(bar.is_scale_bar);
  EXPECT_EQ(layout.distances[0].corner2, 0);
  EXPECT_EQ(layout.distances[0].marker_id2, 120);
  EXPECT_FALSE(layout.distances[0].is_scale_bar);
  EXPECT_FALSE(layout.distances[2].is_scale_bar);
  EXPECT_EQ(layout.distances[2].corner2, 4);
}

TEST(ReadLayout, DictionaryFileIsRelativeToTheLayout) {
  const TempDir dir;
  std::ofstream(dir / "own") << "x";
  EXPECT_EQ(ReadLayout(WriteLayout(dir, "dictionary: own\nmarker_length: 0.1\n")).dictionary,
            (dir / "own").string());
  // A missing file is named with its folder, too.
  EXPECT_EQ(ReadLayout(WriteLayout(dir, "dictionary: no.yml\nmarker_length: 0.1\n")).dictionary,
            (dir / "no.yml").string());
}

TEST(ReadLayout, NamesFileLineAndKeyOfAnError) {
  const TempDir dir;
  const auto expect = [&](const std::string& text, int line, const std::string& part) {
    const std::string path = WriteLayout(dir, text);
    ExpectThrows<InputError>([&] { ReadLayout(path); },
                             {path + ":" + std::to_string(line) + ": ", part});
  };
  const std::string head = "dictionary: DICT_4X4_50\nmarker_length: 0.1\n";
  expect("a: [1\nb: 2\n", 2, "no valid YAML");
  expect("a: [1\nb: 2\n", 2, "a list that begins with [ has to end with ]");
  expect(head + "parts:\n  sail: {markers: [1]\n", 5, "a map that begins with { with }");
  expect(head + "parts:\n\tsail:\n\t\tmarkers: [1]\n", 4, "indented by a tab; use spaces");
  expect(head + "parts:\n  sail:\n\tmarkers: [1]\n", 5, "indented by a tab; use spaces");
  expect("dictionary: D\nmarker_length 0.1\nborder_bits: 1\n", 3, "a space after the colon");
  expect("- 1\n", 1, "a map");
  expect("marker_length: 0.1\n", 1, "key 'dictionary' is missing");
  expect("dictionary: DICT_4X4_50\n", 1, "key 'marker_length' is missing");
  expect(head + "marker_size: 3\n", 3,
         "unknown key; did you mean marker_length? known here: border_bits dictionary");
  expect(head + "parts: {sail: {horizonal: [{name: h1, markers: [1]}]}}\n", 3,
         "did you mean horizontal? known here: ");
  expect(head + "parts: {hull: {markers: [1]}}\nreference_part: hul\n", 4,
         "there is no part 'hul'; did you mean hull? known here: hull");
  expect(head + "marker_length: 0.2\n", 3, "marker_length: is given twice");
  expect("dictionary: D\nmarker_length: 100mm\n", 2, "a length in metres");
  for (const char* length : {"0", "-0.1", "0.00001", "100", "nan", "inf"}) {
    expect(std::string("dictionary: D\nmarker_length: ") + length + "\n", 2, "marker_length");
  }
  expect(head + "marker_lengths: {x: 0.1}\n", 3, "'x' is not a marker id");
  expect(head + "marker_lengths: {5: 100}\n", 3, "marker_lengths.5: 100 m");
  expect(head + "border_bits: 0\n", 3, "border_bits");
  expect(head + "parts:\n", 3, "parts: has no value");
  expect(head + "parts: {}\n", 3, "no part is named");
  expect(head + "parts: {sail: {}}\n", 3, "parts.sail: the part has no markers");
  expect(head + "parts:\n  sail:\n    markers: [1, -2]\n", 5, "parts.sail.markers[1]: '-2'");
  expect(head + "parts:\n  sail:\n    markers: [1, 9000]\n", 5, "0 to 8191");
  expect(head + "parts:\n  sail:\n    markers: [1, 2.5]\n", 5, "'2.5' is not a marker id");
  expect(head + "parts:\n  sail:\n    markers: 7\n", 5, "a list is expected");
  expect(head + "parts:\n  sail:\n    rigid: perhaps\n", 5, "true or false");
  expect(head + "parts:\n  sail:\n    horizontal:\n      - {name: h, markers: [1, 2, 1]}\n", 6,
         "parts.sail.horizontal[0].markers[2]: marker 1 is named twice");
  expect(head + "parts:\n  sail:\n    horizontal:\n      - {markers: [1, 2]}\n", 6, "needs a name");
  expect(head + "parts:\n  sail:\n    vertical:\n      - {name: v}\n", 6, "needs markers");
  expect(head +
             "parts:\n  sail:\n    vertical:\n      - {name: v, markers: [1]}\n"
             "      - {name: v, markers: [2]}\n",
         7, "a second line 'v'");
  expect(head + "parts:\n  sail: {markers: [1, 2]}\n  hull: {markers: [2]}\n", 5,
         "marker 2 is in part 'sail' already");
  expect(head + "parts:\n  sail: {markers: [1]}\nreference_part: mast\n", 5, "no part 'mast'");
}

TEST(ReadLayout, NamesFileLineAndKeyOfAWrongDistance) {
  const TempDir dir;
  // Line 4 is `entry`, after parts with markers 12 and 45.
  const auto expect = [&](const std::string& entry, const std::string& part) {
    const std::string path =
        WriteLayout(dir, "dictionary: DICT_4X4_50\nmarker_length: 0.1\ndistances:\n  - " + entry +
                             "\nparts: {s: {markers: [12, 45]}}\n");
    ExpectThrows<InputError>([&] { ReadLayout(path); }, {path + ":4: distances[0]", part});
  };
  expect("{from: 12, to: 46, length: 1, sigma: 0.01}", "marker 46 is in no part");
  expect("{from: 12, to: 12, length: 1, sigma: 0.01}", "the same point");
  expect("{from: 12.2, to: 12.2, length: 1, sigma: 0.01}", "the same point");
  expect("{from: 12, to: 45, length: 1}", "key 'sigma' is missing");
  expect("{from: 12, length: 1, sigma: 0.01}", "key 'to' is missing");
  expect("{from: 12, to: 45, length: 1, sigma: 0.01, tape: 3}", "unknown key");
  expect("{from: 12, to: 45, length: 1, sigma: 0.01, use: maybe}", ".use: 'maybe'");
  expect("{from: 12, to: 45, length: 1, sigma: 2}", "not below the length");
  expect("7", "a map");
  for (const char* length : {"0", "-1", "nan", "inf"}) {
    expect(std::string("{from: 12, to: 45, sigma: 0.01, length: ") + length + "}",
           ".length: " + std::string(length));
    expect(std::string("{from: 12, to: 45, length: 1, sigma: ") + length + "}", ".sigma: ");
  }
  expect("{from: 12, to: 45, length: 2 m, sigma: 0.01}", "'2 m' is not a number");
  for (const char* point :
       {"12.5", "12.0", "12.", "12.10", ".1", "-3", "x", "9000", "12.1.1", "[1]"}) {
    expect(std::string("{to: 12, length: 1, sigma: 0.01, from: ") + point + "}",
           "is not a point of a marker");
  }
  const std::string empty =
      WriteLayout(dir, "dictionary: DICT_4X4_50\nmarker_length: 0.1\ndistances: []\n");
  ExpectThrows<InputError>([&] { ReadLayout(empty); }, {empty + ":3: distances: no distance"});
}

TEST(ReadLayout, ReadsKnownPoints) {
  const TempDir dir;
  const Layout layout = ReadLayout(WriteLayout(dir, R"(dictionary: DICT_4X4_50
marker_length: 0.1
known_points:
  - {at: 12, x: 0.0, y: -1.5, z: 2, sigma: 0.002}
  - {at: 45.3, x: 2.4, z: 1.3, sigma: 0.001, use: frame}
  - {at: 60, z: 0.0, sigma: 0.003, use: check}
)"));
  ASSERT_EQ(layout.known_points.size(), 3u);
  const KnownPoint &first = layout.known_points[0], &corner = layout.known_points[1],
                   &level = layout.known_points[2];
  EXPECT_EQ(first.marker_id, 12);
  EXPECT_EQ(first.corner, 0);
  EXPECT_THAT(first.x_m, ElementsAre(0.0, -1.5, 2.0));
  EXPECT_EQ(first.sigma_m, 0.002);
  EXPECT_FALSE(first.is_check);
  EXPECT_EQ(corner.corner, 3);
  EXPECT_EQ(corner.x_m[0], 2.4);
  EXPECT_FALSE(corner.x_m[1]);
  EXPECT_EQ(corner.x_m[2], 1.3);
  EXPECT_FALSE(corner.is_check);
  EXPECT_EQ(level.NumCoordinates(), 1);
  EXPECT_TRUE(level.is_check);
}

TEST(ReadLayout, NamesFileLineAndKeyOfAWrongKnownPoint) {
  const TempDir dir;
  // Line 4 is `entry`, before parts with markers 12 and 45.
  const auto expect = [&](const std::string& entry, const std::string& part) {
    const std::string path =
        WriteLayout(dir, "dictionary: DICT_4X4_50\nmarker_length: 0.1\nknown_points:\n  - " +
                             entry + "\nparts: {s: {markers: [12, 45]}}\n");
    ExpectThrows<InputError>([&] { ReadLayout(path); }, {path + ":4: known_points[0]", part});
  };
  expect("{at: 46, x: 1, sigma: 0.01}", "marker 46 is in no part");
  expect("{at: 12, sigma: 0.01}", "no coordinate is given");
  expect("{at: 12, x: 1}", "key 'sigma' is missing");
  expect("{x: 1, sigma: 0.01}", "key 'at' is missing");
  expect("{at: 12.5, x: 1, sigma: 0.01}", "'12.5' is not a point of a marker");
  expect("{at: 12, x: 1, sigma: 0.01, use: scale}", ".use: 'scale': frame");
  expect("{at: 12, x: 1, sigma: 0.01, w: 3}", "unknown key; known here: at sigma use x y z");
  expect("{at: 12, x: 1 m, sigma: 0.01}", ".x: '1 m' is not a number");
  expect("[12, 1, 2, 3]", "a map");
  for (const char* number : {"nan", "inf", "-1000000000"}) {
    expect(std::string("{at: 12, sigma: 0.01, y: ") + number + "}", ".y: " + std::string(number));
  }
  for (const char* sigma : {"0", "-0.01", "nan", "inf", "2", "1e-09"}) {
    expect(std::string("{at: 12, x: 1, sigma: ") + sigma + "}", ".sigma: " + std::string(sigma));
  }
  const std::string head = "dictionary: DICT_4X4_50\nmarker_length: 0.1\n";
  const auto expect_line = [&](const std::string& text, const std::string& error) {
    const std::string path = WriteLayout(dir, head + text);
    ExpectThrows<InputError>([&] { ReadLayout(path); }, {path + error});
  };
  expect_line("known_points: []\n", ":3: known_points: no point is given");
  expect_line("known_points:\n  - {at: 1.2, x: 1, sigma: 0.1}\n  - {at: 1.2, y: 1, sigma: 0.1}\n",
              ":5: known_points[1]: point 1.2 is given twice");
  expect_line("frame: known_points\n",
              ":3: frame: the frame of the known points needs more of them (key 'known_points'): "
              "none is given, apart from checks");
  expect_line(
      "known_points:\n  - {at: 1, x: 1, y: 0, z: 0, sigma: 0.1}\n"
      "  - {at: 2, x: 1, y: 0, z: 0, sigma: 0.1}\nframe: known_points\n",
      ":6: frame: the frame of the known points needs more of them (key 'known_points'): "
      "2 points are given; three are needed");
}

// The edges of a sail of two horizontal lines and a vertical one, with `more_lines` and `markers`.
ClothEdges EdgesOf(const std::string& path, const std::string& edges, const std::string& more_lines,
                   const std::string& markers) {
  std::ofstream(path) << "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts:\n  sail:\n"
                         "    edges: {"
                      << edges
                      << "}\n    horizontal:\n      - {name: h1, markers: [1, 2]}\n"
                         "      - {name: h2, markers: [3, 4]}\n"
                      << more_lines << "    vertical:\n      - {name: v1, markers: [2, 4]}\n"
                      << markers;
  return ReadLayout(path).parts[0].edges;
}

TEST(ReadLayout, ReadsTheEdgesOfTheCloth) {
  const TempDir dir;
  const auto edges_of = [&](const std::string& edges) {
    return EdgesOf(dir / "edges.yml", edges, "", "");
  };
  const ClothEdges edges = edges_of("luff: [0.05, 0.07], leech: {line: v1}, head: 0.2");
  EXPECT_THAT(edges.luff.offsets_m, ElementsAre(0.05, 0.07));
  EXPECT_EQ(edges.leech.line, "v1");
  EXPECT_FALSE(edges.foot.IsKnown());
  EXPECT_THAT(edges.head.offsets_m, ElementsAre(0.2));
  EXPECT_THAT(edges_of("luff: 0").luff.offsets_m, ElementsAre(0.0));
  const auto expect = [&](const std::string& text, const std::string& error) {
    ExpectThrows<InputError>([&] { edges_of(text); }, {"edges.yml:5: parts.sail.edges", error});
  };
  expect("luff: -0.01", ".luff: -0.01 m is out of range; give 0 to 200 m");
  expect("luff: [0.1]", ".luff: 1 distances for 2 horizontal lines");
  expect("leech: [0.1, far]", ".leech[1]: 'far' is not a number");
  expect("leech: {line: v2}", ".leech: there is no vertical line 'v2'");
  expect("leech: {name: v1}", "name");
  expect("foot: [0.1, 0.2]", ".foot: one distance in m is expected");
  expect("top: 0.1", "top");
}

TEST(ReadLayout, ReadsLinesAndPointsAlongTheEdges) {
  const TempDir dir;
  const auto edges_of = [&](const std::string& edges) {
    return EdgesOf(dir / "edges.yml", edges, "      - {name: h3, markers: [5, 6]}\n",
                   "    markers: [21, 22]\n");
  };
  const ClothEdges edges = edges_of(
      "luff: {line: v1, offset: 0.02}, leech: {points: [2, 4.3]}, "
      "foot: {points: [21, 1.4, 22], offset: 0.03}, head: {line: h3}");
  EXPECT_EQ(edges.luff.line, "v1");
  EXPECT_THAT(edges.luff.offsets_m, ElementsAre(0.02));
  EXPECT_THAT(edges.leech.points, ElementsAre(CornerId{2, 0}, CornerId{4, 3}));
  EXPECT_TRUE(edges.leech.IsKnown());
  EXPECT_THAT(edges.foot.points, ElementsAre(CornerId{21, 0}, CornerId{1, 4}, CornerId{22, 0}));
  EXPECT_THAT(edges.foot.offsets_m, ElementsAre(0.03));
  EXPECT_EQ(edges.head.line, "h3");
  // A layout may list its lines from head to foot.
  EXPECT_EQ(edges_of("foot: {line: h3}, head: {line: h1}").foot.line, "h3");
  const auto expect = [&](const std::string& text, const std::string& error) {
    ExpectThrows<InputError>([&] { edges_of(text); }, {"edges.yml:5: parts.sail.edges", error});
  };
  expect("foot: {line: h2}",
         ".foot: 'h2' is neither the first nor the last horizontal line; expected 'h1' or "
         "'h3', or {points: [...]}");
  expect("foot: {line: h1}, head: {line: h1}", "foot and head are the same line 'h1'");
  expect("foot: {line: h1, points: [21, 22]}", ".foot: one of line and points is expected");
  expect("luff: {offset: 0.1}", ".luff: one of line and points is expected");
  expect("luff: {points: [21, 22], offset: -1}", ".luff.offset: -1 m is out of range");
  expect("leech: {points: [21]}", ".leech.points: one point is no edge; name two or more");
  expect("leech: {points: [21, 7]}", ".leech.points[1]: marker 7 is not in the part");
  expect("leech: {points: [21, 21]}", ".leech.points[1]: point 21 is named twice");
  expect("leech: {points: [21, 2.5]}", ".leech.points[1]: '2.5' is not a point of a marker");
  expect(
      "head: {points: [5, 21]}",
      ".head.points[0]: the centre of marker 5 is on the line h3, which cannot also be the edge; "
      "name a corner of it, such as 5.4, or {line: h3}");
}

TEST(ReadLayout, TheOnlyLineOfAPartIsNamedOnce) {
  const TempDir dir;
  ExpectThrows<InputError>(
      [&] {
        ReadLayout(WriteLayout(dir,
                               "dictionary: D\nmarker_length: 0.1\nparts: {sail: {edges: {foot: "
                               "{line: h2}}, horizontal: [{name: h1, markers: [1, 2]}]}}\n"));
      },
      {"'h2' is neither the first nor the last horizontal line; expected 'h1', or {points: "
       "[...]}"});
}

TEST(ReadLayout, WithoutPartsAnyMarkerMayHaveADistance) {
  const TempDir dir;
  const Layout layout =
      ReadLayout(WriteLayout(dir,
                             "dictionary: D\nmarker_length: 0.1\n"
                             "distances: [{from: 7, to: 8, length: 1, sigma: 0.01}]\n"));
  EXPECT_EQ(layout.distances.at(0).marker_id1, 7);
}

TEST(ReadLayout, LeadingZerosAreDecimal) {
  const TempDir dir;
  const Layout layout = ReadLayout(WriteLayout(
      dir, "dictionary: DICT_4X4_50\nmarker_length: 0.1\nparts: {s: {markers: [010, 09]}}\n"));
  EXPECT_THAT(MarkerIds(layout), ElementsAre(9, 10));
}

TEST(MakeLayout, WelcomesEveryId) {
  const Layout layout = MakeLayout("DICT_4X4_50", 0.05);
  EXPECT_FALSE(layout.HasMarkers());
  EXPECT_TRUE(MarkerIds(layout).empty());
  EXPECT_EQ(MarkerLength(layout, 33), 0.05);
  for (const double length_m : {0.0, -1.0, 11.0, 0.00009, std::nan("")}) {
    ExpectThrows<InputError>([&] { MakeLayout("DICT_4X4_50", length_m); }, {"--marker_length"});
  }
}

TEST(AdjacencyGraph, FollowsFromLinesAndRigidParts) {
  const TempDir dir;
  const AdjacencyGraph graph = BuildAdjacencyGraph(ReadLayout(WriteLayout(dir, kSail)));
  EXPECT_THAT(graph.at(1), ElementsAre(2));
  EXPECT_THAT(graph.at(2), ElementsAre(1, 3, 12));
  EXPECT_THAT(graph.at(12), ElementsAre(2, 11, 13, 22));
  EXPECT_THAT(graph.at(90), ElementsAre());
  EXPECT_THAT(graph.at(121), ElementsAre(120, 122));
  for (const auto& [id, neighbors] : graph) {
    for (const int neighbor : neighbors) {
      EXPECT_THAT(graph.at(neighbor), testing::Contains(id));
    }
  }
}

TEST(AdjacencyGraph, DistancesCountEdges) {
  const TempDir dir;
  const AdjacencyGraph graph = BuildAdjacencyGraph(ReadLayout(WriteLayout(dir, kSail)));
  const std::map<int, int> distances = TopologicalDistances(graph, 1);
  EXPECT_EQ(distances,
            (std::map<int, int>{{1, 0}, {2, 1}, {3, 2}, {12, 2}, {11, 3}, {13, 3}, {22, 3}}));
  EXPECT_TRUE(TopologicalDistances(graph, 555).empty());
}

}  // namespace
}  // namespace velamap
