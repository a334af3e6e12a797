// The command shape_comparer on files.

#include "exporters/compare/comparison_sigma.h"
#include "exporters/compare/shape_deviation.h"
#include "exporters/formats/mesh_writer.h"
#include "exporters/formats/shape_csv.h"
#include "importer/base/atomic_output.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/workflows/commands/stages_fixture.h"

namespace velamap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kLayout = R"(
dictionary: DICT_4X4_250
marker_length: 0.1
reference_part: hull
parts:
  sail:
    horizontal:
      - {name: h1, markers: [11, 12, 13, 14, 15, 16]}
      - {name: h2, markers: [21, 22, 23, 24, 25, 26]}
      - {name: h3, markers: [31, 32, 33, 34, 35, 36]}
      - {name: h4, markers: [41, 42, 43, 44, 45, 46]}
      - {name: h5, markers: [51, 52, 53, 54, 55, 56]}
  hull: {markers: [120, 121, 122, 123, 124, 125], rigid: true}
)";

class ShapeComparerTest : public StagesTest {
 protected:
  void SetUp() override {
    WriteTextFile(dir_ / "layout.yml", kLayout);
    WriteShape("a/shape", Moved(FarPose(), Shifted(IdsOf("sail"), {0, 0.03, 0}, BoatShape(0.001))));
    WriteShape("b/shape", BoatShape(0.001));
  }

  void WriteShape(const std::string& folder, const MarkerShape& shape) {
    fs::create_directories(dir_ / folder);
    WriteFileAtomically(dir_ / folder / "shape.csv",
                        [&](std::ostream& out) { WriteShapeCsv(shape, out); });
  }

  void WriteMesh(const std::string& name, double factor) {
    TriangleMesh mesh = SailMesh();
    for (Eigen::Vector3d& x : mesh.vertices_m) x *= factor;
    WriteFileAtomically(dir_ / name, [&](std::ostream& out) {
      WriteMeshPly(mesh, "sail", PlyFormat::kBinaryLittleEndian, out);
    });
  }

  ProgramRun Compare(const std::string& reference, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"shape_comparer", "--shape_path", path("a/shape"),
                                          "--reference_path", path(reference)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  }
};

TEST_F(ShapeComparerTest, TwoShapesByTheHull) {
  const ProgramRun run = Compare(
      "b/shape", {"--layout_path", path("layout.yml"), "--output_path", path("c.ply"), "--csv_path",
                  path("c.csv"), "--json_path", path("c.json"), "--surface_path", path("s.ply")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("surfaces: part sail, surface_distance_mm mean "));
  EXPECT_THAT(ReadFileBytes(dir_ / "s.ply"), HasSubstr("property float distance\n"));
  EXPECT_THAT(run.out, AllOf(HasSubstr("alignment: reference_part\n"),
                             HasSubstr("num_markers: 36\n"), HasSubstr("difference_mm_max: 30\n"),
                             HasSubstr("parts: part hull, distance_mm mean"),
                             HasSubstr("lines: part sail, line h5,"),
                             HasSubstr("section_differences: part sail, section h1, "
                                       "number chord_mm")));
  EXPECT_THAT(ReadFileBytes(dir_ / "c.csv"), HasSubstr("markers,0,significance,"));
  EXPECT_THAT(ReadFileBytes(dir_ / "c.json"), HasSubstr("\"section_differences\": ["));
  EXPECT_THAT(ReadFileBytes(dir_ / "c.ply"), HasSubstr("property float distance\n"));
}

TEST_F(ShapeComparerTest, AShapeWithItself) {
  const ProgramRun run = Compare("a/shape/shape.csv", {"--align", "none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("alignment: none\n"), HasSubstr("distance_mm_max: 0\n"),
                             HasSubstr("num_significant: 0\n")));
}

// Such as the truth of a rendered clip, or a design by its markers.
TEST_F(ShapeComparerTest, AReferenceWithoutSigmasCountsAsExact) {
  MarkerShape truth = BoatShape();
  for (ShapeMarker& marker : truth.markers) marker.sigma_m.fill(std::nullopt);
  WriteShape("truth", truth);
  const ProgramRun run = Compare("truth", {"--layout_path", path("layout.yml")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("truth: has no sigmas, so it counts as exact"));
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("num_with_sigma: 36\n"), HasSubstr("num_significant: 30\n")));
}

TEST_F(ShapeComparerTest, NamedMarkers) {
  const ProgramRun run = Compare("b/shape", {"--align", "markers", "--align_markers", "11,16,53"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("alignment_by: markers 11 16 53, 12 corners of 3 markers\n"));
  ExpectError(Compare("b/shape", {"--align_markers", "11"}), 2, "--align markers");
  ExpectError(Compare("b/shape", {"--align", "markers", "--align_markers", "11,x"}), 2,
              "expected a list of marker ids");
  ExpectError(Compare("b/shape", {"--align", "hull"}), 2, "--align: 'hull' is unknown");
}

TEST_F(ShapeComparerTest, ADesignAsMesh) {
  WriteMesh("design.ply", 1.0);
  const ProgramRun run =
      Compare("design.ply", {"--layout_path", path("layout.yml"), "--part", "sail", "--output_path",
                             path("c.ply"), "--color_limit", "5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("alignment: best_fit\n"), HasSubstr("num_markers: 30\n"),
                             HasSubstr("num_beside_surface: 0\n"), Not(HasSubstr("difference"))));
  EXPECT_THAT(ReadFileBytes(dir_ / "c.ply"), HasSubstr("blue -5 mm, white 0, red +5 mm"));
  ExpectError(Compare("design.ply", {"--part", "jib"}), 2, "there are: hull, sail");
  ExpectError(Compare("design.ply", {"--align", "reference_part"}), 2, "best_fit or none");
  ExpectError(Compare("design.ply", {"--align", "none"}), 1, "none of the 36 whole markers");
}

// The markers of the shape itself lie off a fitted surface by its residuals, which say how well it
// is known.
TEST_F(ShapeComparerTest, ASurfaceOfVelamapIsAsGoodAsItsResiduals) {
  WriteMesh("surface_2.ply", 1.0);
  const std::vector<std::string> of_sail = {"--layout_path", path("layout.yml"), "--part", "sail"};
  EXPECT_THAT(Compare("surface_2.ply", of_sail).out, Not(HasSubstr("reference_sigma_mm")));
  const std::string header = "marker_id,line,u,v,distance,beyond_edge,is_used\n";
  WriteTextFile(dir_ / "surface_residuals_2.csv", header + "11,h1,0,0,0.003,0,1\n");
  const ProgramRun run = Compare("surface_2.ply", of_sail);
  EXPECT_THAT(run.out, HasSubstr("reference_sigma_mm: 3\n"));
  EXPECT_THAT(run.err, HasSubstr("surface_2.ply: known to 3 mm, by "));
  WriteTextFile(dir_ / "surface_residuals_2.csv", header + "11,h1,0,0,far,0,1\n");
  const ProgramRun bad = Compare("surface_2.ply", of_sail);
  EXPECT_EQ(bad.exit_code, 0);
  EXPECT_THAT(bad.out, Not(HasSubstr("reference_sigma_mm")));
  EXPECT_THAT(bad.err, HasSubstr("the surface counts as exact: "));
}

TEST_F(ShapeComparerTest, AFolderWithAPageAndTheDeflections) {
  const ProgramRun run =
      Compare("b/shape", {"--layout_path", path("layout.yml"), "--comparison_path",
                          path("comparison"), "--Surface.grid_points", "11"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(ListFolder(dir_ / "comparison"),
              ElementsAre(".velamap", "comparison.html", "deflection.csv", "deflection.vts"));
  EXPECT_THAT(ReadFileBytes(dir_ / "comparison/comparison.html"),
              AllOf(HasSubstr("<h1>a against b</h1>"), Not(HasSubstr(dir_.path().string()))));
  EXPECT_THAT(ReadFileBytes(dir_ / "comparison/deflection.vts"),
              HasSubstr("WholeExtent=\"0 10 0 40 0 0\""));
  // It is replaced as a whole, unless somebody has put something there.
  EXPECT_EQ(Compare("b/shape", {"--comparison_path", path("comparison")}).exit_code, 0);
  EXPECT_THAT(ListFolder(dir_ / "comparison"), ElementsAre(".velamap", "comparison.html"));
  WriteTextFile(dir_ / "comparison/notes.txt", "mine");
  ExpectError(Compare("b/shape", {"--comparison_path", path("comparison")}), 2, "notes.txt");
}

TEST_F(ShapeComparerTest, ASeriesAgainstOneReference) {
  WriteShape("c/shape", Shifted(IdsOf("sail"), {0, 0.01, 0}, BoatShape(0.001)));
  const std::vector<std::string> series = {"--series_paths",
                                           path("c/shape") + "," + path("b/shape"), "--layout_path",
                                           path("layout.yml")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), series.begin(), series.end());
    return Compare("b/shape", more);
  };
  const ProgramRun run = with({"--comparison_path", path("comparison")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("shapes: shape a, alignment reference_part"),
                             HasSubstr("shapes: shape c,"), HasSubstr("shapes: shape b,"),
                             HasSubstr("section_differences: shape c, part sail, section h1")));
  EXPECT_THAT(ListFolder(dir_ / "comparison"),
              ElementsAre(".velamap", "comparison.html", "deflection.csv", "deflection_a.vts",
                          "deflection_b.vts", "deflection_c.vts"));
  EXPECT_THAT(ReadFileBytes(dir_ / "comparison/deflection.csv"), HasSubstr("\nc,sail,1,1,0,0,"));
  ExpectError(with({"--output_path", path("c.ply")}), 2, "--output_path: is for one shape");
  ExpectError(with({"--csv_path", path("c/shape/shape.csv")}), 2, "--series_paths");
  ExpectError(Compare("b/shape", {"--series_paths", path("b/shape") + ",nothing"}), 2,
              "--series_paths: 'nothing' does not exist");
  ExpectError(Compare("b/shape", {"--series_paths", ""}), 2, "--series_paths");
}

TEST_F(ShapeComparerTest, MarkersBeyondTheEdgeOfADesignCountUpToATolerance) {
  const TriangleMesh mesh = SailMesh(-0.02);
  WriteFileAtomically(dir_ / "design.ply", [&](std::ostream& out) {
    WriteMeshPly(mesh, "sail", PlyFormat::kBinaryLittleEndian, out);
  });
  WriteShape("sail/shape", MarkersOnPart(BoatShape(), {}, "sail"));
  const auto compare = [&](const std::string& tolerance_mm) {
    return RunVelamap({"shape_comparer", "--shape_path", path("sail/shape"), "--reference_path",
                       path("design.ply"), "--align", "none", "--edge_tolerance", tolerance_mm});
  };
  EXPECT_THAT(compare("40").out,
              AllOf(HasSubstr("num_beyond_edge: 18\n"), HasSubstr("num_beside_surface: 0\n")));
  EXPECT_THAT(compare("5").out, AllOf(HasSubstr("num_beside_surface: 18\n"),
                                      HasSubstr("beside_surface_ids: 11 12 13 14 15 16 21 26")));
  ExpectError(compare("-1"), 2, "--edge_tolerance");
}

TEST_F(ShapeComparerTest, AMeshInAnotherUnit) {
  WriteMesh("mm.ply", 1e3);
  WriteMesh("small.ply", 1e-3);
  ExpectError(Compare("mm.ply"), 2, "give --reference_unit mm");
  ExpectError(Compare("small.ply"), 2,
              "check that it is a surface of the same object; if it is right as it is, "
              "give --reference_unit m");
  EXPECT_EQ(Compare("mm.ply", {"--reference_unit", "mm", "--part", "sail"}).exit_code, 0);
  ExpectError(Compare("mm.ply", {"--reference_unit", "inch"}), 2, "give m or mm");
}

TEST_F(ShapeComparerTest, AShapeInMillimetresIsRefused) {
  MarkerShape in_mm = BoatShape(0.001);
  for (ShapeMarker& marker : in_mm.markers) {
    for (auto& x : marker.x_in_shape_m) *x *= 1e3;
  }
  WriteShape("mm/shape", in_mm);
  const std::string wrong = "mm/shape: is 1000 times as large as ";
  ExpectError(Compare("mm/shape"), 2, wrong);
  ExpectError(Compare("mm/shape"), 2, "give metres, not millimetres");
  ExpectError(Compare("b/shape", {"--series_paths", path("mm/shape")}), 2, wrong);
  const auto compare_mm = [&](const std::string& reference, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"shape_comparer", "--shape_path", path("mm/shape"),
                                          "--reference_path", path(reference)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  };
  ExpectError(compare_mm("b/shape", {}), 2, wrong);
  // Where there is no other shape, or it is as wrong, the markers tell.
  ExpectError(compare_mm("mm/shape", {}), 2, "sides of 100 m, expected at most 10 m");
  WriteMesh("design.ply", 1.0);
  ExpectError(compare_mm("design.ply", {}), 2, "sides of 100 m, expected at most 10 m");
  ExpectError(compare_mm("design.ply", {"--layout_path", path("layout.yml")}), 2,
              "1000 times as large as the layout says: give metres");
  ExpectError(RunVelamap({"shoot_planner", "--shape_path", path("mm/shape"), "--layout_path",
                          path("layout.yml"), "--field_of_view", "90", "--width", "1920",
                          "--height", "1080", "--output_path", path("plan")}),
              2, "1000 times as large as the layout says: give metres");
  ExpectError(RunVelamap({"shape_analyzer", "--shape_path", path("b/shape"), "--reference_path",
                          path("mm/shape")}),
              2, wrong);
}

TEST_F(ShapeComparerTest, ShapesOfDifferentObjectsGetABadVerdict) {
  MarkerShape other = BoatShape(0.001);  // each marker where another one was
  for (std::size_t i = 0; i < other.markers.size(); ++i) {
    other.markers[i].x_in_shape_m = BoatShape().markers[7 * i % other.markers.size()].x_in_shape_m;
  }
  WriteShape("other/shape", other);
  const ProgramRun run = Compare("other/shape");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("verdict: bad\nverdict_reason: bad; the two shapes are not of the "
                                 "same object: "));
  EXPECT_THAT(Compare("b/shape").out, Not(HasSubstr("verdict")));
}

TEST_F(ShapeComparerTest, JointUncertaintyIsUsedWhereItBelongs) {
  AdjustmentUncertainty uncertainty;
  uncertainty.points = CovarianceFromSigmas(BoatShape(0.001));
  fs::create_directories(dir_ / "b/sparse/0");
  WriteUncertainty(uncertainty, {}, path("b/sparse/0"));
  const ProgramRun beside = Compare("b/shape");
  EXPECT_THAT(beside.err, HasSubstr("joint uncertainty from"));
  EXPECT_EQ(Compare("b/shape/shape.csv").out, beside.out);
  const ProgramRun named = Compare("b/shape", {"--uncertainty_path", path("b/sparse/0")});
  EXPECT_EQ(named.exit_code, 0) << named.err;
  uncertainty.points = CovarianceFromSigmas(BoatShape(0.005));
  WriteUncertainty(uncertainty, {}, path("b/sparse/0"));
  const ProgramRun of_another = Compare("b/shape");
  EXPECT_THAT(of_another.err, Not(HasSubstr("joint uncertainty from")));
  EXPECT_THAT(of_another.err, HasSubstr("as if they were independent"));
  ExpectError(Compare("b/shape", {"--reference_uncertainty_path", path("b/sparse/0")}), 2,
              "the sigmas differ");
  ExpectError(Compare("b/shape", {"--uncertainty_path", path("a")}), 2, "uncertainty.bin");
}

TEST_F(ShapeComparerTest, BadInput) {
  ExpectError(Compare("no.stl"), 2, "no.stl");
  WriteTextFile(dir_ / "design.stl", "no mesh");
  ExpectError(Compare("design.stl"), 2, "design.stl");
  WriteTextFile(dir_ / "design.blend", "BLENDER");
  ExpectError(Compare("design.blend"), 2, "design.blend");
  ExpectError(Compare("nothing"), 2, "nothing");
  MarkerShape other = BoatShape();
  for (ShapeMarker& marker : other.markers) marker.marker_id += 500;
  WriteShape("other", other);
  ExpectError(Compare("other"), 1, "0 marker corners in common");
  ExpectError(Compare("b/shape", {"--color_limit", "0"}), 2, "--color_limit");
  ExpectError(Compare("b/shape", {"--chord_deviation", "-1"}), 2, "--chord_deviation");
  ExpectError(Compare("b/shape", {"--align_start", "here"}), 2, "--align_start");
  ExpectError(Compare("b/shape", {"--align_start", "as_is"}), 2, "--align_start: it would change");
  WriteMesh("design.ply", 1);
  ExpectError(Compare("design.ply", {"--align_start", "as_is", "--align", "none"}), 2,
              "--align_start: it would change");
}

TEST_F(ShapeComparerTest, OutputThatCannotBeWritten) {
  for (const char* option : {"--output_path", "--csv_path", "--json_path", "--surface_path"}) {
    ExpectError(
        Compare("b/shape", {option, path("layout.yml/c"), "--layout_path", path("layout.yml")}), 2,
        "layout.yml: cannot be written");
  }
  ExpectError(Compare("b/shape", {"--output_path", path("c.html")}), 2,
              "would hold a PLY file; name it .ply, or give --comparison_path");
  ExpectError(Compare("b/shape", {"--surface_path", path("c")}), 2, "needs --layout_path");
  ExpectError(Compare("b/shape", {"--csv_path", path("c"), "--json_path", path("c")}), 2,
              "--json_path");
  EXPECT_THAT(ListFolder(dir_.path()), ElementsAre("a", "b", "layout.yml"));
}

}  // namespace
}  // namespace velamap
