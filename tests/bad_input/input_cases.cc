// Files, folders and options of the main job that are none. Each case breaks one thing of a call
// that fails for want of markers only.

#include <regex>

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

std::string Call(const std::string& image_path, const std::string& camera_path,
                 const std::string& markers = "--dictionary DICT_4X4_50 --marker_length 0.1") {
  return "automatic_reconstructor --image_path @/" + image_path + " --camera_path @/" +
         camera_path + " --workspace_path @/new " + markers;
}

const std::string kCall = Call("grey", "camera.yml");

std::vector<BadInput> Pictures() {
  return {
      {"NoMarkerAtAll", kCall, 1, "no marker of DICT_4X4_50"},
      {"MissingImageFolder", Call("nowhere", "camera.yml"), 2, "nowhere"},
      {"ControlCharactersInAName", Call("no\x1b[31mwhere\x07", "camera.yml"), 2, "no?[31mwhere?"},
      {"EmptyImageFolder", Call("empty", "camera.yml"), 2, "empty",
       [](const fs::path& dir) { fs::create_directory(dir / "empty"); }},
      {"NoFileIsAnImage", kCall, 2, "none of 2 images can be read",
       [](const fs::path& dir) {
         for (const char* name : {"grey/a.png", "grey/b.png"}) {
           WriteTextFile(dir / name, "no image");
         }
       }},
      {"FoldersInCircles", Call("circle", "camera.yml"), 1, "found in 1 frames",
       [](const fs::path& dir) {
         fs::create_directory(dir / "circle");
         fs::copy(dir / "grey/a.png", dir / "circle/a.png");
         fs::create_directory_symlink(dir / "circle", dir / "circle/again");
         fs::create_directory_symlink("..", dir / "circle/up");
         fs::remove_all(dir / "images");
         fs::remove_all(dir / "workspace");
         fs::remove_all(dir / "grey");
       }},
      {"VideoThatIsNone", Call("video.mp4", "camera.yml"), 2, "video.mp4",
       Write("video.mp4", "no video")},
      {"SingleImage", Call("grey/a.png", "camera.yml"), 2, "a single image"}};
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

std::vector<BadInput> Calibrations() {
  const std::string bad = Call("grey", "bad.yml");
  const std::string head = "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n";
  return {{"MissingCalibration", Call("grey", "nowhere.yml"), 2, "nowhere.yml"},
          {"IncompleteCalibration", bad, 2, "camera_matrix", Write("bad.yml", head)},
          {"EmptyCalibration", bad, 2, "is empty", Write("bad.yml", " \n")},
          {"CalibrationForAnotherResolution", kCall, 2, "camera.yml",
           [](const fs::path& dir) { Replace(dir / "camera.yml", "320", "400"); }},
          {"CalibrationOfNegativeFocalLength", kCall, 2, "must be positive",
           [](const fs::path& dir) { Replace(dir / "camera.yml", "[300", "[-300"); }}};
}

// Files on which OpenCV's parsers crash, as a calibration and as a dictionary.
std::vector<BadInput> Walls() {
  constexpr std::size_t kDeep = 200000;
  const auto repeat = [](const std::string& text) {
    std::string repeated;
    for (std::size_t i = 0; i < kDeep; ++i) repeated += text;
    return repeated;
  };
  std::string aliases = "%YAML:1.0\n---\na0: &a0 1\n";
  for (int i = 1; i < 12; ++i) {
    aliases += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) aliases += (k > 0 ? ", *a" : "*a") + std::to_string(i - 1);
    aliases += "]\n";
  }
  const std::string xml = "<?xml version=\"1.0\"?>\n<opencv_storage>";
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"XmlCutOffInAnAttribute", xml + "\n<camera_matrix type_id="},
      {"XmlCutOffInItsFirstLine", "<?xml version=\"1."},
      {"XmlCutOffInAnElement", xml + "<image_width>320</image_wi"},
      {"XmlOfAnotherProgram", "<?xml version=\"1.0\"?>\n<svg></svg>"},
      {"DeepXml", xml + repeat("<a>") + repeat("</a>") + "</opencv_storage>"},
      {"DeepJson", "{\"a\":" + repeat("[") + repeat("]") + "}"},
      {"DeepYaml", "%YAML:1.0\n---\na: " + repeat("[") + repeat("]") + "\n"},
      {"YamlCutOff", "%YAML:1.0\n---\na: [1, 2"},
      {"YamlOfAList", "%YAML:1.0\n---\n- 1\n- 2\n"},
      {"YamlOfText", "%YAML:1.0\n---\nonly text\n"},
      {"YamlOfAliases", aliases},
      {"YamlOfDocumentsWithoutEnd", "%YAML:1.0\n---\nn\n---\n,markers: 2\nmarkersize: 3\n"},
      {"YamlOfADocumentAfterTheEnd",
       "%YAML:1.0\nnmarkers: 1\n...\n---\na: " + std::string(200000, '[')},
      {"YamlOfAnAliasOfItself", "%YAML:1.0\n---\na: &a [*a, *a]\n"},
      {"JsonCutOff", "{\"image_width\": 320,"},
      {"ZeroBytes", std::string("%YAML:1.0\n---\na: \0\0\n", 19)}};
  std::vector<BadInput> cases;
  for (const auto& [name, text] : texts) {
    cases.push_back({"Calibration" + name, Call("grey", "bad.yml"), 2,
                     "bad.yml: not a readable OpenCV FileStorage file", Write("bad.yml", text)});
    cases.push_back({"Dictionary" + name,
                     Call("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1"), 2,
                     "bad.yml: not a readable OpenCV FileStorage file", Write("bad.yml", text)});
  }
  const std::vector<std::pair<std::string, std::string>> calls = {
      {"Calibration", Call("grey", "bad.yml")},
      {"Dictionary", Call("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1")},
      {"ProjectFile", "shape_analyzer --project_path @/bad.yml"},
      {"Layout", Call("grey", "camera.yml", "--layout_path @/bad.yml")}};
  for (const auto& [name, call] : calls) {
    cases.push_back(
        {name + "OfAByteOrderMarkAlone", call, 2, "is empty", Write("bad.yml", "\xef\xbb\xbf")});
    cases.push_back({name + "OfTwoByteOrderMarks", call, 2, "two byte order marks",
                     Write("bad.yml", "\xef\xbb\xbf\xef\xbb\xbf")});
    cases.push_back(
        {name + "OfManyBytes", call, 2, "check that it is the right file", [](const fs::path& dir) {
           WriteTextFile(dir / "bad.yml", "%YAML");
           fs::resize_file(dir / "bad.yml", (std::uintmax_t{16} << 20) + 1);
         }});
  }
  return cases;
}

// Numbers that cannot be.
std::vector<BadInput> Numbers() {
  const auto model_with = [](const std::string& file, const std::string& from,
                             const std::string& to) {
    return [=](const fs::path& dir) {
      fs::create_directory(dir / "model");
      for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
        fs::copy(dir / "workspace/sparse/0" / name, dir / "model" / name);
      }
      Replace(dir / "model" / file, from, to);
    };
  };
  const std::string exported =
      "shape_exporter --marker_length 0.1 --input_path @/model --shape_path @/out";
  const std::string adjusted =
      "bundle_adjuster --backend markers --marker_length 0.1 --input_path @/model --output_path "
      "@/out";
  const std::string analyzed = "shape_analyzer --marker_length 0.1 --shape_path @/bad.csv";
  const std::string header = "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n";
  const auto negative = model_with("cameras.txt", "320 240 300 ", "320 240 300 -");
  const auto far = [=](const fs::path& dir) {
    model_with("points3D.txt", "", "")(dir);
    const std::string text = ReadFileBytes(dir / "model/points3D.txt");
    WriteTextFile(dir / "model/points3D.txt",
                  std::regex_replace(text, std::regex("\\n(\\d+) \\S+ "), "\n$1 1e200 "));
  };
  const std::string registered =
      "frame_registrator --marker_length 0.1 --database_path @/workspace/database.db "
      "--output_path @/out";
  return {
      {"FocalLengthBelowZeroInOneAxis", Call("grey", "bad.txt"), 2, "must be positive",
       Write("bad.txt", "1 PINHOLE 320 240 300 -300 160 120\n")},
      {"FocalLengthBelowZeroInADatabase", registered, 2, "not positive",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db",
                "UPDATE cameras SET params = CAST(zeroblob(8) || substr(params, 9) AS BLOB)");
       }},
      {"MarkerIdsOfADatabaseOutOfRange", registered, 2, "is no marker id",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db",
                "UPDATE marker_detections SET marker_id = marker_id + 10000");
       }},
      {"ADatabaseWithoutTheCamerasOfItsImages", registered, 2, "names camera 1",
       [](const fs::path& dir) { RunSql(dir / "workspace/database.db", "DELETE FROM cameras"); }},
      {"AnUnknownCameraModelOfADatabase", registered, 2, "does not know",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE cameras SET model = 99");
       }},
      {"ACameraWithoutPixelsInADatabase", registered, 2, "without pixels",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE cameras SET width = 0");
       }},
      {"FocalLengthBelowZeroExported", exported, 2, "not positive", negative},
      {"FocalLengthBelowZeroAdjusted", adjusted, 2, "not positive", negative},
      {"AFarPointExported", exported, 2, "has a coordinate beyond", far},
      {"AFarPointAdjusted", adjusted, 2, "has a coordinate beyond", far},
      {"AFarCorner", analyzed, 2, "bad.csv:2", Write("bad.csv", header + "1,1,1e200,0,0,,,,2,\n")},
      {"AFarCornerOfAReference",
       "shape_comparer --shape_path @/workspace/shape --reference_path @/bad.csv", 2, "bad.csv:2",
       Write("bad.csv", header + "1,1,0,-1e200,0,,,,2,\n")},
      {"AShapeOfManyBytes", analyzed, 2, "bad.csv: 268435457 bytes are too many for a shape.csv",
       [](const fs::path& dir) {
         WriteTextFile(dir / "bad.csv", "marker_id");
         fs::resize_file(dir / "bad.csv", (std::uintmax_t{256} << 20) + 1);
       }},
      {"AFarVertex", "shape_comparer --shape_path @/workspace/shape --reference_path @/bad.obj", 2,
       "bad.obj", Write("bad.obj", "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n")}};
}

// A reference of these formats is read in a process of its own.
std::vector<BadInput> Meshes() {
  const auto compared = [](const std::string& reference) {
    return "shape_comparer --shape_path @/workspace/shape --reference_path @/" + reference;
  };
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\nproperty list uchar int vertex_indices\n";
  return {{"PlyHeaderThatDoesNotEnd", compared("bad.ply"), 2, "bad.ply: cannot be read",
           Write("bad.ply", ply + "end_header,\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")},
          {"StepCutOff", compared("bad.step"), 2, "bad.step: is cut off",
           Write("bad.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=DIRECTION('',(0.,0.,")},
          {"StepOfNothing", compared("bad.step"), 2, "bad.step: cannot be read as STEP",
           Write("bad.step", "END-ISO-10303-21;\n")},
          {"IgesCutOff", compared("bad.igs"), 2, "bad.igs: is cut off",
           Write("bad.igs", std::string(72, ' ') + "S      1\n")},
          {"ObjWithoutFaces", compared("bad.obj"), 2, "bad.obj", Write("bad.obj", "v 0 0 0\n")},
          {"MeshOfManyBytes", compared("bad.stl"), 2, "bad.stl: has 536870913 bytes",
           [](const fs::path& dir) {
             WriteTextFile(dir / "bad.stl", "solid");
             fs::resize_file(dir / "bad.stl", (std::uintmax_t{512} << 20) + 1);
           }}};
}

std::vector<BadInput> Markers() {
  std::vector<BadInput> cases = {
      {"DictionaryThatDoesNotExist",
       Call("grey", "camera.yml", "--dictionary DICT_4X4_51 --marker_length 0.1"), 2,
       "DICT_4X4_51"},
      {"DictionaryFileWithWrongBits",
       Call("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1"), 2, "marker_0",
       Write("bad.yml",
             "%YAML:1.0\n---\nnmarkers: 1\nmarkersize: 3\nmaxCorrectionBits: 0\nmarker_0: "
             "\"1010\"\n")},
      {"NoDictionary", Call("grey", "camera.yml", "--marker_length 0.1"), 2,
       "--layout_path: missing"},
      {"LayoutAndItsReplacement",
       Call("grey", "camera.yml", "--layout_path @/nowhere.yml --marker_length 0.1"), 2,
       "leave out"},
      {"MissingLayout", Call("grey", "camera.yml", "--layout_path @/nowhere.yml"), 2,
       "nowhere.yml"}};
  for (const char* length : {"0", "-0.1", "1000", "nan", "ten"}) {
    cases.push_back({"MarkerLength" + std::to_string(cases.size()),
                     Call("grey", "camera.yml",
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
          {"WishForTooFewKnownPoints", wish, 2, "2 points are given, three are needed",
           points({zero, one})},
          {"WishForLevels", wish, 2, "they have z alone",
           points({"at: 0, z: 0, sigma: 0.002", "at: 1, z: 0, sigma: 0.002",
                   "at: 2, z: 0, sigma: 0.002"})},
          {"WishForKnownPointsOfAnotherSize", wish, 2, "times as far apart as in the shape",
           points({zero, "at: 1, x: 90, y: 0, z: 0, sigma: 0.002",
                   "at: 3, x: 0, y: 90, z: 0, sigma: 0.002"})}};
}

std::vector<BadInput> PriorShapes() {
  const std::string header = "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n";
  const std::string call = kCall + " --prior_shape_path @/prior.csv";
  return {
      {"MissingPriorShape", call, 2, "prior.csv"},
      {"PriorShapeInAFolderWithoutOne", kCall + " --prior_shape_path @/grey", 2, "grey/shape.csv"},
      {"PriorShapeWithoutAWholeMarker", call, 2, "no marker has all four corners",
       Write("prior.csv", header + "1,1,0,0,0,,,,2,\n")},
      {"PriorShapeThatIsNoNumber", call, 2, "prior.csv:2",
       Write("prior.csv", header + "1,1,0,nan,0,,,,2,\n")}};
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
      {"ColmapAbsent", kCall + " --colmap_path @/colmap", 3, "/colmap"},
      {"ColmapThatIsAnotherProgram", kCall + " --colmap_path /bin/true", 3, "/bin/true"}};
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
                     kCall + " " + name + " " + value, 2, name});
  }
  return cases;
}

}  // namespace

std::vector<BadInput> InputCases() {
  std::vector<BadInput> cases = Pictures();
  for (const auto& more : {Boards(), Calibrations(), Walls(), Numbers(), Meshes(), Markers(),
                           KnownPoints(), PriorShapes(), Workspaces(), Options()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
