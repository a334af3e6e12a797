// Calibrations, dictionaries, databases, models, shapes and meshes that cannot be read, or that
// hold what cannot be.

#include <regex>

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

std::vector<BadInput> Calibrations() {
  const std::string bad = MainJob("grey", "bad.yml");
  const std::string head = "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n";
  return {
      {"MissingCalibration", MainJob("grey", "nowhere.yml"), 2, "nowhere.yml"},
      {"IncompleteCalibration", bad, 2, "camera_matrix", Write("bad.yml", head)},
      {"CalibrationOfAFocalLengthWithoutEnd", kMainJob, 2, "a focal length of 1e+300 px",
       [](const fs::path& dir) { Replace(dir / "camera.yml", "[300", "[1e300"); }},
      {"CalibrationOfBytes", bad, 2, "key 'camera_matrix': dt is 'u'; expected d",
       Write("bad.yml", head + "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: u\n"
                               "   data: [ 9, 0, 3, 0, 9, 3, 0, 0, 1 ]\n"
                               "distortion_coefficients: [0, 0, 0, 0]\n")},
      {"CalibrationOfTooFewNumbers", bad, 2, "not a readable matrix; a list of numbers",
       Write("bad.yml", head + "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                               "   data: [ 9, 0, 3 ]\ndistortion_coefficients: [0, 0, 0, 0]\n")},
      {"EmptyCalibration", bad, 2, "is empty", Write("bad.yml", " \n")},
      {"CalibrationForAnotherResolution", kMainJob, 2, "camera.yml",
       [](const fs::path& dir) { Replace(dir / "camera.yml", "320", "400"); }},
      {"CalibrationOfNegativeFocalLength", kMainJob, 2, "must be positive",
       [](const fs::path& dir) { Replace(dir / "camera.yml", "[300", "[-300"); }}};
}

// Names and texts on which OpenCV's parsers crash.
std::vector<std::pair<std::string, std::string>> TextsForWalls() {
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
  return {{"XmlCutOffInAnAttribute", xml + "\n<camera_matrix type_id="},
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
}

// The same texts as a calibration and as a dictionary.
std::vector<BadInput> Walls() {
  std::vector<BadInput> cases;
  for (const auto& [name, text] : TextsForWalls()) {
    cases.push_back({"Calibration" + name, MainJob("grey", "bad.yml"), 2,
                     "bad.yml: not a readable OpenCV FileStorage file", Write("bad.yml", text)});
    cases.push_back({"Dictionary" + name,
                     MainJob("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1"), 2,
                     "bad.yml: not a readable cv::aruco dictionary file", Write("bad.yml", text)});
  }
  return cases;
}

// Byte order marks, other encodings, and too many bytes.
std::vector<BadInput> Encodings() {
  std::vector<BadInput> cases;
  const std::vector<std::pair<std::string, std::string>> calls = {
      {"Calibration", MainJob("grey", "bad.yml")},
      {"Dictionary", MainJob("grey", "camera.yml", "--dictionary @/bad.yml --marker_length 0.1")},
      {"ProjectFile", "shape_analyzer --project_path @/bad.yml"},
      {"Layout", MainJob("grey", "camera.yml", "--layout_path @/bad.yml")}};
  for (const auto& [name, call] : calls) {
    cases.push_back(
        {name + "OfAByteOrderMarkAlone", call, 2, "is empty", Write("bad.yml", "\xef\xbb\xbf")});
    if (name == "Dictionary" || name == "Layout") {
      cases.push_back({name + "InLatin1", call, 2, "bad.yml:2: not UTF-8; save the file as UTF-8",
                       Write("bad.yml", "# names of parts\n# Gro\xdfsegel: 1\n")});
    }
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

// Databases that are read but hold impossible numbers.
std::vector<BadInput> NumbersOfDatabases() {
  const std::string registered =
      "frame_registrator --marker_length 0.1 --database_path @/workspace/database.db "
      "--output_path @/out";
  return {
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
      {"ATimeOfADatabaseThatIsAText", registered, 2, "time_s is 'noon', not a number",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE marker_detections SET time_s = 'noon'");
       }},
      {"ADatabaseWithoutTheCamerasOfItsImages", registered, 2, "names camera 1",
       [](const fs::path& dir) { RunSql(dir / "workspace/database.db", "DELETE FROM cameras"); }},
      {"AnUnknownCameraModelOfADatabase", registered, 2, "does not know",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE cameras SET model = 99");
       }},
      {"ACameraWithoutPixelsInADatabase", registered, 2, "without pixels", [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE cameras SET width = 0");
       }}};
}

// Files that are read but hold impossible numbers.
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
  return {
      {"FocalLengthBelowZeroInOneAxis", MainJob("grey", "bad.txt"), 2, "must be positive",
       Write("bad.txt", "1 PINHOLE 320 240 300 -300 160 120\n")},
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

std::vector<BadInput> PriorShapes() {
  const std::string header = "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n";
  const std::string call = kMainJob + " --prior_shape_path @/prior.csv";
  return {{"MissingPriorShape", call, 2, "prior.csv"},
          {"PriorShapeInAFolderWithoutOne", kMainJob + " --prior_shape_path @/grey", 2,
           "grey/shape.csv"},
          {"PriorShapeWithoutAWholeMarker", call, 2, "no marker has all four corners",
           Write("prior.csv", header + "1,1,0,0,0,,,,2,\n")},
          {"PriorShapeThatIsNoNumber", call, 2, "prior.csv:2",
           Write("prior.csv", header + "1,1,0,nan,0,,,,2,\n")}};
}

}  // namespace

std::vector<BadInput> FileCases() {
  std::vector<BadInput> cases = Calibrations();
  for (const auto& more :
       {Walls(), Encodings(), NumbersOfDatabases(), Numbers(), Meshes(), PriorShapes()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
