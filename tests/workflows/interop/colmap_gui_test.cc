// A result in COLMAP's own window.

#include <cstdlib>

#include "tests/workflows/interop/colmap_tools.h"
#include "tests/workflows/run_velamap.h"
#include "tests/workflows/stylus_workspace.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

class ColmapGuiTest : public ColmapTest {};

TEST_F(ColmapGuiTest, ShowsPointsAndCamerasOfAResult) {
  for (const char* program : {"xvfb-run", "xdotool", "import", "convert", "compare"}) {
    if (std::system((std::string("command -v ") + program + " > /dev/null 2>&1").c_str()) != 0) {
      GTEST_SKIP() << program << " is not on the PATH";
    }
  }
  CopyStylusWorkspace(path("stylus"));
  fs::create_directories(VELAMAP_PICTURE_DIR);
  const std::string picture = (fs::path(VELAMAP_PICTURE_DIR) / "stylus.png").string();
  fs::remove(picture);
  // A few centimetres are next to nothing in the first view: nearer, and with smaller cameras.
  const ProgramRun gui =
      RunProgram(VELAMAP_GUI_SCRIPT, {path("stylus/database.db"), path("stylus/images"),
                                      path("stylus/sparse/0"), picture, "18", "0", "0", "24"});
  EXPECT_EQ(gui.exit_code, 0) << gui.err;
  EXPECT_TRUE(fs::exists(picture));
}

}  // namespace
}  // namespace velamap
