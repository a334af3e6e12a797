// STEP and IGES, read back with Open CASCADE.

#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/design/cad_reader.h"
#include "exporters/formats/cad_writer.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/formats/cad_names.h"
#include "tests/exporters/formats/mesh_area.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/error_matchers.h"
#include "tests/support/scoped_date.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr double kAnyChordMm = 1.0;

std::string Step(const SplineSurface& surface, const std::string& name = "sail") {
  std::ostringstream out;
  WriteStep(surface, name, out);
  return out.str();
}

std::string Iges(const SplineSurface& surface, const std::string& name = "sail") {
  std::ostringstream out;
  WriteIges(surface, name, out);
  return out.str();
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string ReadErrorOf(const std::filesystem::path& path) {
  try {
    ReadCad(path, kAnyChordMm);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

// Extents of the surface from a dense mesh.
void Extents(const SplineSurface& surface, Eigen::Vector3d* min_m, Eigen::Vector3d* max_m) {
  MeshOptions options;
  options.edge_length_mm = 20;
  const TriangleMesh mesh = MeshSurface(surface, options);
  *min_m = *max_m = mesh.vertices_m.front();
  for (const Eigen::Vector3d& x : mesh.vertices_m) {
    *min_m = min_m->cwiseMin(x);
    *max_m = max_m->cwiseMax(x);
  }
}

TEST(Cad, ReadBackWithSameAreaExtentsAndUnit) {
  TempDir dir;
  for (const auto& truth : {BilinearPatch, CylinderSail, TwistedSail}) {
    const SplineSurface surface = FitSurface(MarkersOn(truth, 6, 7)).surface;
    Eigen::Vector3d min_m, max_m;
    Extents(surface, &min_m, &max_m);
    WriteText(dir / "sail.step", Step(surface));
    WriteText(dir / "sail.igs", Iges(surface));
    for (const char* name : {"sail.step", "sail.igs"}) {
      const CadFaces shape = ReadCadFaces(dir / name);
      const TriangleMesh mesh = ReadCad(dir / name, kAnyChordMm);
      EXPECT_THAT(shape.length_unit, AnyOf("MM", "millimetre")) << name;
      EXPECT_EQ(shape.num_faces, 1);
      EXPECT_NEAR(shape.area_m2, SurfaceArea(surface), 1e-7 * shape.area_m2) << name;
      EXPECT_LT((shape.min_m - min_m).cwiseAbs().maxCoeff(), 1e-4) << name;
      EXPECT_LT((shape.max_m - max_m).cwiseAbs().maxCoeff(), 1e-4) << name;
      EXPECT_NEAR(Area(mesh), shape.area_m2, 1e-3 * shape.area_m2) << name;
      double largest_mm = 0;
      for (const SurfaceFoot& foot : ProjectOnSurface(surface, mesh.vertices_m)) {
        largest_mm = std::max(largest_mm, 1000 * std::abs(foot.distance_m));
      }
      EXPECT_LT(largest_mm, 1e-3) << name;
    }
  }
}

TEST(Cad, HeadersSayMillimetresAndTheSchema) {
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  const std::string step = Step(surface);
  EXPECT_THAT(step, HasSubstr("SI_UNIT(.MILLI.,.METRE.)"));
  EXPECT_THAT(step, HasSubstr("AUTOMOTIVE_DESIGN { 1 0 10303 214"));
  EXPECT_THAT(step, HasSubstr("PRODUCT('sail','sail'"));
  const std::string iges = Iges(surface);
  EXPECT_THAT(iges, HasSubstr("2HMM"));
  EXPECT_THAT(iges, HasSubstr("4Hsail"));
  EXPECT_THAT(iges, HasSubstr("8Hsail.igs"));
  CadExtras extras;
  extras.iges_file_name = "surface_2.igs";
  std::ostringstream named;
  WriteIges(surface, "jib", named, extras);
  EXPECT_THAT(named.str(), HasSubstr("13Hsurface_2.igs"));
}

TEST(Cad, DatesAreReal) {
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  {
    const ScopedDate date("1700000000");
    EXPECT_THAT(Step(surface), HasSubstr("'2023-11-14T22:13:20'"));
    EXPECT_THAT(Iges(surface), HasSubstr("15H20231114.221320"));
  }
  const std::time_t now = std::time(nullptr);
  const std::string year = std::to_string(1900 + std::gmtime(&now)->tm_year);
  EXPECT_THAT(Step(surface), HasSubstr("'" + year + "-"));
}

// A parabola and two markers beside the surface.
CadExtras ExampleExtras() {
  CadCurve curve{"h1", 2, Eigen::ArrayXd(6), Eigen::Matrix3Xd(3, 3)};
  curve.knots << 0, 0, 0, 1, 1, 1;
  curve.poles_in_shape_m << 0, 1, 2, 0, 0.5, 0, 3, 3, 3.25;
  CadCurve other = curve;
  other.name = "h\xC3\xB6he 2";
  other.poles_in_shape_m.row(2).array() += 1;
  return {{curve, other}, {{"12", {0.25, 0.5, 3}}, {"120", {1, -2, 3.5}}}};
}

TEST(Cad, SectionsAndMarkersKeepTheirNamesBesideTheSurface) {
  TempDir dir;
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  std::ostringstream step, iges;
  WriteStep(surface, "sail", step, ExampleExtras());
  WriteIges(surface, "sail", iges, ExampleExtras());
  WriteText(dir / "a.step", step.str());
  WriteText(dir / "a.igs", iges.str());
  for (const char* name : {"a.step", "a.igs"}) {
    const CadFaces shape = ReadCadFaces(dir / name);
    EXPECT_EQ(shape.num_faces, 1) << name;
    EXPECT_NEAR(shape.area_m2, SurfaceArea(surface), 1e-6) << name;
    const CadNames read = ReadCadNames(dir / name);
    ASSERT_EQ(read.curves.size(), 2u) << name;
    ASSERT_EQ(read.points.size(), 2u) << name;
    // The middle of the parabola, and the markers.
    EXPECT_LT((read.curves.at("h1") - Eigen::Vector3d(1, 0.25, 3.0625)).norm(), 1e-9) << name;
    EXPECT_EQ(read.curves.count("h__he 2"), 1u) << name;
    EXPECT_LT((read.points.at("12") - Eigen::Vector3d(0.25, 0.5, 3)).norm(), 1e-9) << name;
    EXPECT_LT((read.points.at("120") - Eigen::Vector3d(1, -2, 3.5)).norm(), 1e-9) << name;
  }
}

TEST(Cad, UnitOfTheFileIsObeyed) {
  TempDir dir;
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  std::string step = Step(surface);
  const std::string millimetre = "SI_UNIT(.MILLI.,.METRE.)";
  step.replace(step.find(millimetre), millimetre.size(), "SI_UNIT($,.METRE.)");
  WriteText(dir / "in_metres.stp", step);
  // The same numbers in metres: the surface is 6 km high, and so coarse is the mesh.
  EXPECT_NEAR(ReadCadFaces(dir / "in_metres.stp").area_m2, 1e6 * SurfaceArea(surface),
              1 * SurfaceArea(surface));
  const TriangleMesh mesh = ReadCad(dir / "in_metres.stp", 1e5);
  EXPECT_NEAR(Area(mesh), 1e6 * SurfaceArea(surface), 1e5 * SurfaceArea(surface));
}

// As in the frame of a national grid, where ten digits are tenths of a millimetre.
TEST(Cad, FarFromTheOriginNothingIsLost) {
  TempDir dir;
  SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  const Eigen::RowVector3d origin_m(456789, 5423456, 312);
  surface.poles_in_shape_m.rowwise() += origin_m;
  WriteText(dir / "far.step", Step(surface));
  WriteText(dir / "far.igs", Iges(surface));
  for (const char* name : {"far.step", "far.igs"}) {
    double largest_mm = 0;
    for (const SurfaceFoot& foot :
         ProjectOnSurface(surface, ReadCad(dir / name, kAnyChordMm).vertices_m)) {
      largest_mm = std::max(largest_mm, 1000 * std::abs(foot.distance_m));
    }
    EXPECT_LT(largest_mm, 1e-3) << name;
  }
}

TEST(Cad, SameSurfaceSameBytes) {
  const ScopedDate date("1700000000");
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  const std::string step = Step(surface), iges = Iges(surface);
  EXPECT_EQ(step, Step(surface));
  EXPECT_EQ(iges, Iges(surface));
  const CommaLocale comma;
  EXPECT_EQ(step, Step(surface));
  EXPECT_EQ(iges, Iges(surface));
}

TEST(Cad, NamesThatAreNotAsciiAreWrittenSo) {
  TempDir dir;
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  WriteText(dir / "a.step", Step(surface, "gro\xC3\x9Fsegel 'A'"));
  WriteText(dir / "a.iges", Iges(surface, "gro\xC3\x9Fsegel 'A'"));
  for (const char* name : {"a.step", "a.iges"}) {
    EXPECT_NEAR(ReadCadFaces(dir / name).area_m2, SurfaceArea(surface), 1e-5);
  }
}

TEST(Cad, SaysNothingOnStandardOutput) {
  TempDir dir;
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  ::testing::internal::CaptureStdout();
  WriteText(dir / "a.step", Step(surface));
  WriteText(dir / "a.iges", Iges(surface));
  ReadCad(dir / "a.step", kAnyChordMm);
  ReadCad(dir / "a.iges", kAnyChordMm);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(Cad, UnreadableFilesAreNamed) {
  TempDir dir;
  EXPECT_THAT(ReadErrorOf(dir / "not_there.step"), HasSubstr("not_there.step: cannot be read"));
  WriteText(dir / "bad.step", "nothing of the kind\n");
  EXPECT_THAT(ReadErrorOf(dir / "bad.step"), HasSubstr("bad.step: "));
  WriteText(dir / "bad.IGS", "nothing of the kind\n");
  EXPECT_THAT(ReadErrorOf(dir / "bad.IGS"), HasSubstr("bad.IGS: "));
  const std::string step = Step(FitSurface(MarkersOn(TwistedSail, 4, 5)).surface);
  WriteText(dir / "half.step", step.substr(0, step.size() / 2));
  EXPECT_THAT(ReadErrorOf(dir / "half.step"), HasSubstr("half.step: "));
}

TEST(Cad, UnwritableOutputIsNamedAndNothingIsLeft) {
  TempDir dir;
  WriteText(dir / "file", "in the way");
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 4, 5)).surface;
  const auto path = dir / "file" / "sail.step";
  ExpectThrows<InputError>(
      [&] {
        WriteFileAtomically(path, [&](std::ostream& out) { WriteStep(surface, "sail", out); });
      },
      {"file: cannot be written"});
}

TEST(Cad, FullStreamIsNoBrokenInvariant) {
  std::ofstream full("/dev/full");
  if (!full) GTEST_SKIP() << "no /dev/full";
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 12, 12)).surface;
  WriteStep(surface, "sail", full);
  full.flush();
  EXPECT_FALSE(full.good());
  std::ofstream full_again("/dev/full");
  WriteIges(surface, "sail", full_again);
  full_again.flush();
  EXPECT_FALSE(full_again.good());
}

}  // namespace
}  // namespace velamap
