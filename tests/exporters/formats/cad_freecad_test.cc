// FreeCAD's importer reads the written files, if FreeCAD is installed (Debian: freecad-python3).

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "exporters/formats/cad_writer.h"
#include "importer/base/atomic_output.h"
#include "tests/exporters/formats/cad_names.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

// Imports the files like File > Import and writes the area and extents of each, mm.
constexpr const char* kScript = R"(
import FreeCAD, Import
out = open("@FOLDER@/result.txt", "w")
for name in ("sail.step", "sail.iges"):
    document = FreeCAD.newDocument()
    Import.insert("@FOLDER@/" + name, document.Name)
    shapes = [o.Shape for o in document.Objects if o.isDerivedFrom("Part::Feature")]
    assert len(shapes) == 1 and len(shapes[0].Faces) == 1, name
    shape = shapes[0]
    box = shape.optimalBoundingBox() if hasattr(shape, "optimalBoundingBox") else shape.BoundBox
    numbers = (shape.Area, box.XMin, box.YMin, box.ZMin, box.XMax, box.YMax, box.ZMax)
    out.write(" ".join("%.17g" % number for number in numbers) + "\n")
out.close()
)";

std::string FindFreeCad() {
  for (const char* name : {"freecadcmd", "FreeCADCmd", "freecadcmd-python3"}) {
    const std::string command = std::string("command -v ") + name + " > /dev/null 2>&1";
    if (std::system(command.c_str()) == 0) return name;
  }
  return "";
}

TEST(CadFreeCad, ImportsSameAreaAndExtents) {
  const std::string program = FindFreeCad();
  if (program.empty()) GTEST_SKIP() << "FreeCAD is not on the PATH";
  TempDir dir;
  const std::string folder = dir.path().string();
  const SplineSurface surface = FitSurface(MarkersOn(TwistedSail, 6, 7)).surface;
  WriteFile(dir / "sail.step", [&](std::ostream& out) { WriteStep(surface, "sail", out); });
  WriteFile(dir / "sail.iges", [&](std::ostream& out) { WriteIges(surface, "sail", out); });
  std::string script = kScript;
  const std::string placeholder = "@FOLDER@";
  for (std::size_t at = script.find(placeholder); at != std::string::npos;
       at = script.find(placeholder)) {
    script.replace(at, placeholder.size(), folder);
  }
  WriteFile(dir / "import.py", [&](std::ostream& out) { out << script; });
  const std::string command = "HOME=" + folder + " timeout 300 " + program + " " + folder +
                              "/import.py < /dev/null > " + folder + "/log.txt 2>&1";
  const int status = std::system(command.c_str());
  std::stringstream log;
  log << std::ifstream(dir / "log.txt").rdbuf();
  const CadFaces expected = ReadCadFaces(dir / "sail.step");
  std::ifstream result(dir / "result.txt");
  for (const char* name : {"sail.step", "sail.iges"}) {
    double area_mm2 = 0;
    Eigen::Vector3d min_mm, max_mm;
    result >> area_mm2;
    for (double& x : min_mm) result >> x;
    for (double& x : max_mm) result >> x;
    ASSERT_TRUE(result) << name << ", status " << status << ": " << log.str();
    EXPECT_NEAR(area_mm2, 1e6 * SurfaceArea(surface), 1e-6 * area_mm2) << name;
    EXPECT_LT((min_mm - 1000 * expected.min_m).cwiseAbs().maxCoeff(), 0.1) << name;
    EXPECT_LT((max_mm - 1000 * expected.max_m).cwiseAbs().maxCoeff(), 0.1) << name;
  }
}

}  // namespace
}  // namespace velamap
