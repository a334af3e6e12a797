// Pipes and devices in the place of files: no wait, and one line. Names that a terminal would take
// for commands.

#include <sys/stat.h>

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

const std::string kPhotographs = "automatic_reconstructor --image_path @/images ";
const std::string kCamera = "--camera_path @/camera.yml ";
const std::string kLayout = "--layout_path @/layout.yml ";
const std::string kShapeToCompare = "--shape_path @/workspace/shape ";

void MakePipe(const fs::path& path) { mkfifo(path.c_str(), 0600); }

// One call for each kind of path; PIPE is where the pipe or device goes.
std::vector<std::pair<std::string, std::string>> CallsThatRead() {
  const std::string new_workspace = "--workspace_path @/new";
  return {
      {"Video", "automatic_reconstructor --image_path PIPE " + kCamera + kLayout + new_workspace},
      {"Calibration", kPhotographs + "--camera_path PIPE " + kLayout + new_workspace},
      {"Layout", kPhotographs + kCamera + "--layout_path PIPE " + new_workspace},
      {"Dictionary",
       kPhotographs + kCamera + "--marker_length 0.1 --dictionary PIPE " + new_workspace},
      {"PriorShape", kPhotographs + kCamera + kLayout + "--prior_shape_path PIPE " + new_workspace},
      {"ProjectFile", "automatic_reconstructor --project_path PIPE"},
      {"Database", "frame_registrator " + kLayout + "--database_path PIPE --output_path @/new"},
      {"Parts", "database_merger " + kLayout + "--database_paths PIPE --output_path @/new"},
      {"Model", "shape_exporter " + kLayout + "--input_path PIPE --shape_path @/new"},
      {"Shape", "shape_analyzer " + kLayout + "--shape_path PIPE"},
      {"Reference", "shape_analyzer " + kLayout + kShapeToCompare + "--reference_path PIPE"},
      {"Design", "shape_comparer " + kShapeToCompare + "--reference_path PIPE"},
      {"Edges", "shape_exporter " + kLayout +
                    "--input_path @/workspace/sparse/0 --shape_path @/new "
                    "--Surface.edges_path PIPE"},
      {"CheckedClip", "clip_checker --image_path PIPE " + kCamera + kLayout}};
}

}  // namespace

std::vector<BadInput> ProcessCases() {
  std::vector<BadInput> cases;
  const auto with = [](std::string call, const std::string& path) {
    return call.replace(call.find("PIPE"), 4, path);
  };
  for (const auto& [name, call] : CallsThatRead()) {
    cases.push_back({name + "ThatIsAPipe", with(call, "@/pipe"), 2, "a pipe or a device",
                     [](const fs::path& dir) { MakePipe(dir / "pipe"); }});
    cases.push_back(
        {name + "ThatIsADevice", with(call, "/dev/zero"), 2, "/dev/zero is a pipe or a device"});
  }
  cases.push_back({"APhotographThatIsAPipe", kRerun, 2, "5.png is a pipe or a device",
                   [](const fs::path& dir) { MakePipe(dir / "images/5.png"); }});
  cases.push_back({"AFileOfAModelThatIsAPipe",
                   "shape_exporter " + kLayout + "--input_path @/model --shape_path @/new", 2,
                   "points3D.bin is a pipe or a device", [](const fs::path& dir) {
                     fs::copy(dir / "workspace/sparse/0", dir / "model");
                     fs::remove(dir / "model/points3D.bin");
                     MakePipe(dir / "model/points3D.bin");
                   }});
  cases.push_back(
      {"ALogThatIsAPipe",
       "bundle_adjuster --input_path @/workspace/sparse/seed --output_path @/new --log_path @/pipe",
       2, "pipe is a pipe, and velamap would wait for its reader",
       [](const fs::path& dir) { MakePipe(dir / "pipe"); }});
  cases.push_back(
      {"AnImageNameWithALineBreak", kImport, 2, "holds a line break",
       [](const fs::path& dir) { fs::copy(dir / "images/1.png", dir / "images/five\nsix.png"); }});
  // U+009B begins a command to the terminal as escape and bracket do.
  cases.push_back({"ControlCharactersBeyondAscii",
                   "automatic_reconstructor --image_path @/no\xc2\x9b" + std::string("31mwhere ") +
                       kCamera + kLayout + "--workspace_path @/new",
                   2, "no\xc2?31mwhere"});
  cases.push_back({"AWorkspaceLogThatIsAPipe", kRerun, 2,
                   "velamap.log is a pipe, and velamap would", [](const fs::path& dir) {
                     fs::remove(dir / "workspace/velamap.log");
                     MakePipe(dir / "workspace/velamap.log");
                   }});
  return cases;
}

}  // namespace velamap
