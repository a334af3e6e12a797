// Pictures, boards, markers, known points, workspaces and options that cannot be used. Each case
// breaks one thing of a call that otherwise fails only because the pictures show no marker.

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

std::vector<BadInput> Pictures() {
  return {{"NoMarkerAtAll", kMainJob, 1, "no marker of DICT_4X4_50"},
          {"MissingImageFolder", MainJob("nowhere", "camera.yml"), 2, "nowhere"},
          {"ControlCharactersInAName", MainJob("no\x1b[31mwhere\x07", "camera.yml"), 2,
           "no?[31mwhere?"},
          {"EmptyImageFolder", MainJob("empty", "camera.yml"), 2, "empty",
           [](const fs::path& dir) { fs::create_directory(dir / "empty"); }},
          {"NoFileIsAnImage", kMainJob, 2, "none of 2 images can be read",
           [](const fs::path& dir) {
             for (const char* name : {"grey/a.png", "grey/b.png"}) {
               WriteTextFile(dir / name, "no image");
             }
           }},
          {"FoldersInCircles", MainJob("circle", "camera.yml"), 1, "found in 1 frames",
           [](const fs::path& dir) {
             fs::create_directory(dir / "circle");
             fs::copy(dir / "grey/a.png", dir / "circle/a.png");
             fs::create_directory_symlink(dir / "circle", dir / "circle/again");
             fs::create_directory_symlink("..", dir / "circle/up");
             fs::remove_all(dir / "images");
             fs::remove_all(dir / "workspace");
             fs::remove_all(dir / "grey");
           }},
          {"VideoThatIsNone", MainJob("video.mp4", "camera.yml"), 2, "video.mp4",
           Write("video.mp4", "no video")},
          {"SingleImage", MainJob("grey/a.png", "camera.yml"), 2, "a single image"}};
}

std::vector<BadInput> Boards() {
  const std::string call =
      "camera_calibrator --output_path @/new.yml --image_path @/images --report_path @/new.html ";
  const std::string layout = "--layout_path @/layout.yml ";
  const auto keep_one = [](const fs::path& dir) {
    for (const char* name : {"2.png", "3.png", "4.png"}) {
      fs::copy(dir / "images/1.png", dir / "images" / name, fs::copy_options::overwrite_existing);
    }
  };
  return {
      {"ABoardOfAnotherDictionary", call + "--dictionary DICT_7X7_50 --marker_length 0.1", 1,
       "no marker of DICT_7X7_50"},
      {"ABoardOfOtherIds", call + layout, 1, "layout",
       [](const fs::path& dir) { Replace(dir / "layout.yml", "[0, 1, 2, 3, 4, 5]", "[40, 41]"); }},
      {"AChessboardThatIsNotThere", call + "--Board.chessboard 9x6", 1,
       "no chessboard of 9 x 6 inner corners"},
      {"AChessboardOfOneNumber", call + "--Board.chessboard 9", 2, "--Board.chessboard: '9'"},
      {"AChessboardWithALayout", call + layout + "--Board.chessboard 9x6", 2,
       "--Board.chessboard: a chessboard has no markers"},
      {"NoBoardAtAll", "camera_calibrator --output_path @/new.yml --image_path @/grey", 1,
       "no marker of any of OpenCV's dictionaries"},
      {"ViewsThatAreAllAlike", call + layout, 1, "pictures are alike", keep_one}};
}

std::vector<BadInput> Markers() {
  std::vector<BadInput> cases = {
      {"DictionaryThatDoesNotExist",
       MainJob("grey", "camera.yml", "--dictionary DICT_4X4_51 --marker_length 0.1"), 2,
       "DICT_4X4_51"},
      {"DictionaryFileWithWrongBits",
       MainJob("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1"), 2, "marker_0",
       Write("bad.yml",
             "%YAML:1.0\n---\nnmarkers: 1\nmarkersize: 3\nmaxCorrectionBits: 0\nmarker_0: "
             "\"1010\"\n")},
      {"NoDictionary", MainJob("grey", "camera.yml", "--marker_length 0.1"), 2,
       "--dictionary: missing"},
      {"LayoutAndItsReplacement",
       MainJob("grey", "camera.yml", "--layout_path @/nowhere.yml --marker_length 0.1"), 2,
       "leave out"},
      {"MissingLayout", MainJob("grey", "camera.yml", "--layout_path @/nowhere.yml"), 2,
       "nowhere.yml"}};
  for (const char* length : {"0", "-0.1", "1000", "nan", "ten"}) {
    cases.push_back({"MarkerLength" + std::to_string(cases.size()),
                     MainJob("grey", "camera.yml",
                             std::string("--dictionary DICT_4X4_50 --marker_length ") + length),
                     2, "--marker_length"});
  }
  return cases;
}

// Points of the layout with measured coordinates.
std::vector<BadInput> KnownPoints() {
  const auto points = [](const std::vector<std::string>& entries, const std::string& more = "") {
    return [=](const fs::path& dir) {
      std::string text = ReadFileBytes(dir / "layout.yml") + "known_points:\n";
      for (const std::string& entry : entries) text += "  - {" + entry + "}\n";
      WriteTextFile(dir / "bad.yml", text + more);
    };
  };
  const std::string call =
      "shape_exporter --input_path @/workspace/sparse/0 --shape_path @/out --layout_path @/bad.yml";
  const std::string wish = call + " --frame known_points";
  const std::string zero = "at: 0, x: 0, y: 0, z: 0, sigma: 0.002";
  const std::string one = "at: 1, x: 0.3, y: 0, z: 0, sigma: 0.002";
  return {{"KnownPointOfAnUnknownMarker", call, 2, "known_points[0]: marker 77 is in no part",
           points({"at: 77, x: 0, sigma: 0.002"})},
          {"KnownPointGivenTwice", call, 2, "known_points[1]: point 0 is given twice",
           points({zero, "at: 0, z: 1, sigma: 0.002"})},
          {"KnownPointWithoutACoordinate", call, 2, "no coordinate is given",
           points({"at: 0, sigma: 0.002"})},
          {"KnownPointWithoutASigma", call, 2, "key 'sigma' is missing", points({"at: 0, x: 1"})},
          {"KnownPointOfNegativeSigma", call, 2, ".sigma: -0.002 m is out of range",
           points({"at: 0, x: 1, sigma: -0.002"})},
          {"KnownPointThatIsNoNumber", call, 2, ".y: nan m is out of range",
           points({"at: 0, y: nan, sigma: 0.002"})},
          {"KnownPointFarOff", call, 2, ".z: 1e+200 m is out of range",
           points({"at: 0, z: 1e200, sigma: 0.002"})},
          {"FrameOfTooFewKnownPoints", call, 2, "frame: the frame of the known points needs more",
           points({zero, one}, "frame: known_points\n")},
          {"WishForTooFewKnownPoints", wish, 2, "2 points are given; three are needed",
           points({zero, one})},
          {"WishForLevels", wish, 2, "they have z alone",
           points({"at: 0, z: 0, sigma: 0.002", "at: 1, z: 0, sigma: 0.002",
                   "at: 2, z: 0, sigma: 0.002"})},
          {"WishForKnownPointsOfAnotherSize", wish, 2, "times as far apart as in the shape",
           points({zero, "at: 1, x: 90, y: 0, z: 0, sigma: 0.002",
                   "at: 3, x: 0, y: 90, z: 0, sigma: 0.002"})}};
}

std::vector<BadInput> Workspaces() {
  const auto call = [](const std::string& workspace) {
    return "automatic_reconstructor --image_path @/grey --camera_path @/camera.yml --dictionary "
           "DICT_4X4_50 --marker_length 0.1 --workspace_path " +
           workspace;
  };
  return {
      {"WorkspaceIsAFile", call("@/camera.yml/"), 2, "camera.yml"},
      {"WorkspaceIsAnotherFile", call("@/file"), 2, "is a file", Write("file", "a file")},
      {"WorkspaceBelowAFile", call("@/file/workspace"), 2, "file/workspace",
       Write("file", "a file")},
      {"WorkspaceThatCannotBeMade", call("/proc/velamap/workspace"), 2, "/proc/velamap/workspace"},
      {"WorkspaceAmongThePhotographs", call("@/grey/result"), 2, "lies in the image folder"}};
}

std::vector<BadInput> Options() {
  const std::string project =
      "shape_analyzer --shape_path @/workspace/shape --project_path @/p.ini";
  std::vector<BadInput> cases = {
      {"ProjectFileOfAnUnknownKey", project, 2, "p.ini: unknown key marker_lenght; did you mean",
       Write("p.ini", "\xef\xbb\xbfmarker_lenght=0.1\n")},
      {"ProjectFileThatIsAFolder", "shape_analyzer --project_path @/grey", 2,
       "grey: the project file (--project_path) is not a regular file"},
      {"ProjectFileThatIsMissing", "shape_analyzer --project_path @/p.ini", 2,
       "p.ini: there is no such project file"},
      {"ColmapAbsent", kMainJob + " --colmap_path @/colmap", 3, "/colmap"},
      {"ColmapThatIsAnotherProgram", kMainJob + " --colmap_path /bin/true", 3, "/bin/true"}};
  const std::vector<std::pair<std::string, std::string>> beyond = {
      {"--ArucoDetection.error_correction_rate", "2"},
      {"--ArucoDetection.min_marker_perimeter_rate", "-1"},
      {"--Video.frame_step", "0"},
      {"--Registration.skip", "0"},
      {"--Registration.frequency_threshold", "30"},
      {"--BundleAdjustment.max_num_rounds", "-1"},
      {"--BundleAdjustment.function_tolerance", "-1"},
      {"--num_threads", "-2"},
      {"--random_seed", "-1"}};
  for (const auto& [name, value] : beyond) {
    cases.push_back({"OptionBeyondItsRange" + std::to_string(cases.size()),
                     kMainJob + " " + name + " " + value, 2, name});
  }
  return cases;
}

}  // namespace

std::vector<BadInput> InputCases() {
  std::vector<BadInput> cases = Pictures();
  for (const auto& more : {Boards(), Markers(), KnownPoints(), Workspaces(), Options()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
