#include "tests/workflows/stylus_workspace.h"

#include <cstdlib>
#include <stdexcept>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

fs::path MakeStylusWorkspace() {
  static const TempDir dir;
  const fs::path stylus = fs::path(VELAMAP_SOURCE_DIR) / "sample_project/stylus";
  const ProgramRun run = RunVelamap({"automatic_reconstructor", "--image_path", stylus / "images",
                                     "--camera_path", stylus / "camera.yml", "--layout_path",
                                     stylus / "layout.yml", "--workspace_path", dir / "stylus"});
  if (run.exit_code != 0) throw std::runtime_error(run.err);
  return dir / "stylus";
}

}  // namespace

const fs::path& StylusWorkspace() {
  static const fs::path path = [] {
    const char* of_ctest = std::getenv("VELAMAP_STYLUS_WORKSPACE");
    return of_ctest != nullptr ? fs::path(of_ctest) : MakeStylusWorkspace();
  }();
  return path;
}

void CopyStylusWorkspace(const fs::path& workspace_path) {
  fs::copy(StylusWorkspace(), workspace_path, fs::copy_options::recursive);
}

}  // namespace velamap
