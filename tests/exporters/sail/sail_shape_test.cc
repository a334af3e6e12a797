#include "exporters/sail/sail_shape.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/scale/metric_shape.h"
#include "exporters/shape_exporter.h"
#include "exporters/surface/surface_csv.h"
#include "importer/base/error.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_model.h"
#include "tests/exporters/exported_files.h"
#include "tests/exporters/formats/cad_names.h"
#include "tests/exporters/golden_file.h"
#include "tests/exporters/sail/sail_shapes.h"
#include "tests/support/error_matchers.h"
#include "tests/support/export_shape.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::StartsWith;

SailShape Compute(const Sail& sail, const SailOptions& options = {}) {
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  return ComputeSail(sail.shape, frame, sail.layout, nullptr, options);
}

// Main and jib: the same sail twice, the second one 5 m ahead with other ids.
Sail TwoSails() {
  Sail main = ExampleSail(), jib = ExampleSail();
  for (LayoutPart& part : jib.layout.parts) {
    part.name = "jib";
    part.vertical.clear();
    for (MarkerLine& line : part.horizontal) {
      for (int& id : line.marker_ids) id += 1000;
    }
    main.layout.parts.push_back(part);
  }
  for (ShapeMarker marker : jib.shape.markers) {
    marker.marker_id += 1000;
    marker.part = "jib";
    for (auto& x : marker.x_in_shape_m) x->x() -= 5.0;
    main.shape.markers.push_back(marker);
  }
  return main;
}

TEST(SailShape, HasSectionsAndASurfaceOfEachPartWithLines) {
  const SailShape one = Compute(ExampleSail());
  EXPECT_EQ(one.sections.sections.size(), 3u);
  ASSERT_EQ(one.surfaces.size(), 1u);
  EXPECT_EQ(one.surfaces[0].part, "sail");
  EXPECT_LT(one.surfaces[0].fit.distance_m.rms, 2e-4);
  EXPECT_THAT(one.surface_notes, IsEmpty());
  const SailShape two = Compute(TwoSails());
  EXPECT_EQ(two.sections.sections.size(), 6u);
  ASSERT_EQ(two.surfaces.size(), 2u);
  EXPECT_NEAR(two.surfaces[1].area_m2, two.surfaces[0].area_m2, 1e-9);
}

TEST(SailShape, FilesAreThoseThatItNames) {
  const TempDir dir;
  const Sail sails = TwoSails();
  const ShapeFrame frame = ChooseFrame(sails.shape, sails.layout);
  const SailShape sail = ComputeSail(sails.shape, frame, sails.layout, nullptr, {});
  WriteSailFiles(sail, sails.shape, frame, {}, dir.path());
  const std::set<std::string> files = FilesIn(dir.path());
  EXPECT_THAT(files, IsSupersetOf({"sections.csv", "section_profiles.svg", "surface.step",
                                   "surface_2.igs", "surface_residuals_2.csv", "surface_2.stl",
                                   "surface.vts", "surface_2.msh", "surface_2_ansys.txt"}));
  for (const char* name : {"surface.step", "surface_2.igs"}) {
    EXPECT_NEAR(ReadCadFaces(dir / name).area_m2, sail.surfaces[0].area_m2, 1e-6) << name;
  }
  EXPECT_THAT(ReadBytes(dir / "surface.step"), HasSubstr("frame: lines h1 v1"));
  EXPECT_THAT(ReadBytes(dir / "surface_2.obj"), HasSubstr("jib (frame: lines h1 v1)"));
  EXPECT_THAT(ReadBytes(dir / "surface_2.igs"), HasSubstr("13Hsurface_2.igs"));
  // The sections and markers of the jib, and none of the main.
  const std::string step = ReadBytes(dir / "surface_2.step");
  EXPECT_THAT(step, HasSubstr("sections and markers"));
  EXPECT_THAT(step, HasSubstr("B_SPLINE_CURVE_WITH_KNOTS('h3'"));
  const int main_id = sails.layout.parts[0].horizontal[0].marker_ids[0];
  EXPECT_THAT(step, HasSubstr(fmt::format("CARTESIAN_POINT('{}'", main_id + 1000)));
  EXPECT_THAT(step, Not(HasSubstr(fmt::format("CARTESIAN_POINT('{}'", main_id))));
}

// Height of the middle of an edge.
double EdgeHeight_m(const SailSurface& surface, const std::string& edge) {
  std::vector<double> heights_m;
  for (const SurfaceEdgePoint& point : surface.fit.edges) {
    if (point.edge == edge) heights_m.push_back(point.x_in_shape_m.z());
  }
  return heights_m.at(heights_m.size() / 2);
}

TEST(SailShape, LayoutFromHeadToFootGivesTheSameSurface) {
  Sail sail = ExampleSail();
  LayoutPart& part = sail.layout.parts[0];
  part.edges.foot.offsets_m = {0.1};
  part.edges.head.offsets_m = {0.8};
  const ShapeFrame frame = ChooseFrame(sail.shape, sail.layout);
  const SailShape foot_first = ComputeSail(sail.shape, frame, sail.layout, nullptr, {});
  std::reverse(part.horizontal.begin(), part.horizontal.end());
  for (MarkerLine& line : part.vertical) {
    std::reverse(line.marker_ids.begin(), line.marker_ids.end());
  }
  const SailShape head_first = ComputeSail(sail.shape, frame, sail.layout, nullptr, {});
  ASSERT_EQ(head_first.surfaces.size(), 1u);
  const SailSurface &a = foot_first.surfaces[0], &b = head_first.surfaces[0];
  EXPECT_NEAR(a.area_m2, b.area_m2, 1e-9);
  for (const char* edge : {"foot", "head", "luff", "leech"}) {
    EXPECT_NEAR(EdgeHeight_m(a, edge), EdgeHeight_m(b, edge), 1e-9) << edge;
  }
  EXPECT_NEAR(EdgeHeight_m(b, "foot"), -0.1, 0.02);
}

// The example's markers, which all face the same way, turned into the cloth.
Sail SailWithMarkersInTheCloth() {
  constexpr double kHalf_m = 0.05;
  Sail sail = ExampleSail();
  for (const MarkerLine& line : sail.layout.parts[0].horizontal) {
    const std::vector<int>& ids = line.marker_ids;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const int before = ids[i > 0 ? i - 1 : 0], after = ids[std::min(i + 1, ids.size() - 1)];
      const Eigen::Vector3d right = (*FindWholeMarker(sail.shape, after)->x_in_shape_m[0] -
                                     *FindWholeMarker(sail.shape, before)->x_in_shape_m[0])
                                        .normalized();
      for (ShapeMarker& marker : sail.shape.markers) {
        if (marker.marker_id != ids[i]) continue;
        for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
          const double x = corner == 1 || corner == 4 ? -1 : 1, z = corner <= 2 ? 1 : -1;
          marker.x_in_shape_m[corner] =
              *marker.x_in_shape_m[0] + kHalf_m * (x * right + z * Eigen::Vector3d::UnitZ());
        }
      }
    }
  }
  return sail;
}

// The corners of the outer markers on all sides, 50 mm from their centres.
TEST(SailShape, EndsAtPointsOfTheLayoutInCadToo) {
  Sail sail = SailWithMarkersInTheCloth();
  LayoutPart& part = sail.layout.parts[0];
  const std::vector<int>&low = part.horizontal.front().marker_ids,
        &high = part.horizontal.back().marker_ids;
  for (const int id : low) part.edges.foot.points.push_back({id, 4});
  for (const int id : high) part.edges.head.points.push_back({id, 1});
  part.edges.head.offsets_m = {0.1};
  for (const MarkerLine& line : part.horizontal) {
    part.edges.luff.points.push_back({line.marker_ids.front(), 1});
  }
  part.edges.leech.line = "leech";
  part.vertical.push_back({"leech", {low.back(), high.back()}});
  part.edges.leech.offsets_m = {0.2};
  const SailShape with_edges = Compute(sail);
  ASSERT_EQ(with_edges.surfaces.size(), 1u) << testing::PrintToString(with_edges.surface_notes);
  const SailSurface& surface = with_edges.surfaces[0];
  EXPECT_NEAR(EdgeHeight_m(surface, "foot"), -0.05, 0.02);
  EXPECT_NEAR(EdgeHeight_m(surface, "head"), 4.15, 0.02);
  const double plain_m2 = Compute(ExampleSail()).surfaces[0].area_m2;
  EXPECT_NEAR(surface.area_m2, plain_m2 + 0.05 * 3.1 + 0.15 * 1.7 + 0.25 * 4, 0.1);
  const TempDir dir;
  WriteSailFiles(with_edges, sail.shape, ChooseFrame(sail.shape, sail.layout), {}, dir.path());
  EXPECT_NEAR(ReadCadFaces(dir / "surface.step").area_m2, surface.area_m2, 1e-6);
}

TEST(SailShape, StlFilesThatAreTooCoarseAndLinesFromTheHeadAreWarnedOf) {
  Sail sail = ExampleSail();
  sail.layout.parts[0].vertical.clear();
  ShapeExportReport report;
  report.shape = sail.shape;
  report.sail = Compute(sail);
  EXPECT_THAT(FrameWarnings(report, sail.layout, true), IsEmpty());
  for (Eigen::Vector3d& x_m : report.sail.surfaces[0].mesh.vertices_m) x_m.y() += 5e6;
  EXPECT_THAT(FrameWarnings(report, sail.layout, true),
              ElementsAre(HasSubstr("have steps of 596 mm; give known_points from an origin")));
  EXPECT_THAT(FrameWarnings(report, sail.layout, false), IsEmpty());
  std::reverse(sail.layout.parts[0].horizontal.begin(), sail.layout.parts[0].horizontal.end());
  EXPECT_THAT(FrameWarnings(report, sail.layout, false), ElementsAre(HasSubstr("upside down")));
}

TEST(SailShape, SaysWhyThereIsNoSurface) {
  Sail sail = TwoSails();
  for (const LayoutPart& part : sail.layout.parts) {
    if (part.name != "jib") continue;
    for (const MarkerLine& line : part.horizontal) {
      for (std::size_t i = 2; i < line.marker_ids.size(); ++i) {
        RemoveMarker(line.marker_ids[i], &sail.shape);
      }
    }
  }
  const SailShape result = Compute(sail);
  EXPECT_EQ(result.surfaces.size(), 1u);
  EXPECT_THAT(result.surface_notes, ElementsAre(HasSubstr("jib: no surface: ")));
  EXPECT_EQ(result.sections.missing.size(), 3u);
}

TEST(SailShape, WithoutLinesThereIsOneNote) {
  Sail sail = ExampleSail();
  for (LayoutPart& part : sail.layout.parts) part.horizontal.clear();
  const SailShape result = Compute(sail);
  EXPECT_THAT(result.sections.notes, ElementsAre(HasSubstr("no horizontal lines")));
  EXPECT_THAT(result.surfaces, IsEmpty());
  EXPECT_THAT(result.surface_notes, IsEmpty());
  const TempDir dir;
  WriteSailFiles(result, sail.shape, {}, {}, dir.path());
  EXPECT_THAT(FilesIn(dir.path()), IsEmpty());
}

TEST(SailShape, ResolutionIsAsAskedForAndNotAbsurd) {
  SailOptions options;
  options.mesh = MeshOptions{20.0, std::nullopt};
  const std::size_t fine = Compute(ExampleSail(), options).surfaces[0].mesh.triangles.size();
  EXPECT_GT(fine, 4 * Compute(ExampleSail()).surfaces[0].mesh.triangles.size());
  options.mesh->edge_length_mm = 1e-3;
  const SailShape refused = Compute(ExampleSail(), options);
  EXPECT_THAT(refused.surfaces, IsEmpty());
  EXPECT_EQ(refused.sections.sections.size(), 3u);
  ASSERT_TRUE(refused.surface_error);
  ExpectThrows<InputError>([&] { std::rethrow_exception(refused.surface_error); }, {"triangles"});
  options.mesh->chord_deviation_mm = 1.0;
  EXPECT_THROW(options.Check(), InputError);
}

TEST(SailShape, RefusesEdgesInAnotherUnitOrFrame) {
  SailOptions options;
  options.surface.edges.luff.points_m = {{0, 0, 0}, {0, 0, 5000}};
  const SailShape refused = Compute(ExampleSail(), options);
  EXPECT_THAT(refused.surfaces, IsEmpty());
  EXPECT_EQ(refused.sections.sections.size(), 3u);
  ASSERT_TRUE(refused.surface_error);
  ExpectThrows<InputError>([&] { std::rethrow_exception(refused.surface_error); },
                           {"--Surface.edges_path: the point 0, 0, 5000 is", "m from the markers",
                            "the extent of the markers; give coordinates in m"});
}

TEST(SailShape, GivenEdgesAreThoseOfTheFirstSail) {
  SailOptions options;
  options.surface.edges.luff.points_m = {{-0.2, 0, 0}, {-0.2, 0, 4}};
  const SailShape with_edge = Compute(TwoSails(), options), without = Compute(TwoSails());
  ASSERT_EQ(with_edge.surfaces.size(), 2u);
  EXPECT_EQ(with_edge.surfaces[0].area_m2, Compute(ExampleSail(), options).surfaces[0].area_m2);
  EXPECT_GT(with_edge.surfaces[0].area_m2, without.surfaces[0].area_m2 + 0.5);
  EXPECT_EQ(with_edge.surfaces[1].area_m2, without.surfaces[1].area_m2);
}

TEST(SurfaceEdges, AreReadAndRefusedWithLineAndColumn) {
  const auto read = [](const std::string& text) {
    std::istringstream in(text);
    return ReadSurfaceEdges(in, "edges.csv");
  };
  const SurfaceEdges edges =
      read("# measured\nedge,x,y,z\nluff,0,0,0\nfoot,0,0,0\nluff,0,0.5,4\nfoot,3,0,0\n");
  ASSERT_EQ(edges.luff.points_m.size(), 2u);
  EXPECT_EQ(edges.luff.points_m[1], Eigen::Vector3d(0, 0.5, 4));
  EXPECT_EQ(edges.foot.points_m.size(), 2u);
  EXPECT_THAT(edges.head.points_m, IsEmpty());
  const std::string header = "edge,x,y,z\n";
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"", "expected the header"},
           {"edge,x,y\n", "expected the header"},
           {header + "keel,1,2,3\n",
            "edges.csv:2: column edge: expected luff, leech, foot or head, found 'keel'"},
           {header + "luff,1,2\n", "edges.csv:2: 3 columns"},
           {header + "luff,1,x,3\n",
            "edges.csv:2: column y: expected a number in metres, found 'x'"},
           {header + "luff,1,nan,3\n", "column y"},
           {header + "luff,1e200,2,3\n", "column x: expected a number in metres"},
           {header + "luff,1,2,3\n", "the luff edge has one point"}}) {
    ExpectThrows<InputError>([&, t = text] { read(t); }, {part});
  }
  ExpectThrows<InputError>([] { ReadSurfaceEdges("no/such.csv"); }, {"no/such.csv"});
}

// Two clips of one boat with different cameras and scales have one frame.
TEST(ShapeExporterFrame, ResultsOfDifferentWorldsAreInOneFrame) {
  Model moved = ExampleModel();
  TransformModel(ExampleSim3(7.0), &moved);
  Layout layout = ExampleLayout();
  layout.reference_part = "hull";
  for (const auto& [text, name] :
       std::map<std::string, std::string>{{"reference_part", "reference part hull"},
                                          {"lines", "lines"},
                                          {"1,3,6", "markers 1 3 6"}}) {
    ShapeExporterOptions options;
    options.frame = ParseFrameChoice(text, "--frame");
    const ShapeExportReport a = ExportShape(ExampleModel(), layout, options);
    const ShapeExportReport b = ExportShape(moved, layout, options);
    EXPECT_THAT(a.frame.name, StartsWith(name));
    EXPECT_EQ(a.frame.name, b.frame.name);
    ASSERT_EQ(a.shape.markers.size(), b.shape.markers.size());
    for (std::size_t i = 0; i < a.shape.markers.size(); ++i) {
      for (std::size_t corner = 0; corner <= kNumCorners; ++corner) {
        EXPECT_LT(
            (*a.shape.markers[i].x_in_shape_m[corner] - *b.shape.markers[i].x_in_shape_m[corner])
                .norm(),
            1e-9);
      }
    }
    EXPECT_TRUE(IsShapeOf(a.shape, a.metric_model));
    EXPECT_LT(a.model_metrics.error_px.max, 1e-8);  // the cameras moved along
  }
}

TEST(ShapeExporterFrame, IsNamedInTheFiles) {
  const TempDir dir;
  ShapeExporterOptions options;
  options.shape_output_path = dir / "shape";
  ExportShape(ExampleModel(), ExampleLayout(), options);
  for (const char* file : {"shape.json", "shape.ply", "markers.ply", "metrics.json",
                           "sections.json", "surface.ply", "surface.igs"}) {
    EXPECT_NE(ReadBytes(dir / "shape" / file).find("lines h1 h2"), std::string::npos) << file;
  }
}

}  // namespace
}  // namespace velamap
