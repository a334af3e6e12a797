// Wishes that cannot be granted, and data that have no result.

#include <sstream>

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

const std::string kExport = "shape_exporter --input_path @/workspace/sparse/0 --shape_path @/out ";

std::function<void(const fs::path&)> WriteOwnLayout(const std::string& rest) {
  return [rest](const fs::path& dir) {
    WriteTextFile(dir / "own.yml", "dictionary: DICT_4X4_50\nmarker_length: 0.1\n" + rest);
  };
}

void PutPointsAtOnePlace(const fs::path& dir) {
  fs::create_directory(dir / "model");
  for (const char* file : {"cameras.txt", "images.txt"}) {
    fs::copy(dir / "workspace/sparse/0" / file, dir / "model" / file);
  }
  std::string points;
  std::istringstream lines(ReadFileBytes(dir / "workspace/sparse/0/points3D.txt"));
  for (std::string line, id, number; std::getline(lines, line);) {
    if (line.front() == '#') continue;
    std::istringstream words(line);
    words >> id >> number >> number >> number;
    points += id + " 0.1 0.2 3";
    for (std::string word; words >> word;) points += ' ' + word;
    points += '\n';
  }
  WriteTextFile(dir / "model/points3D.txt", points);
}

std::vector<BadInput> Frames() {
  return {{"FrameByMarkersThatAreNotThere", kExport + "--marker_length 0.1 --frame 900,901,902", 2,
           "--frame: the frame 'markers 900 901 902' is not possible"},
          {"FrameByMarkersThatTheLayoutDoesNotName",
           kExport + "--layout_path @/layout.yml --frame 7,8,9", 2,
           "--frame: the frame 'markers 7 8 9' is not possible: the layout names no marker 7"},
          {"FrameByAReferencePartThatIsNone",
           kExport + "--layout_path @/layout.yml --frame reference_part", 2,
           "the layout names no reference_part"},
          {"FrameByLinesThatAreNone", kExport + "--marker_length 0.1 --frame lines", 2,
           "the layout has no horizontal lines"},
          {"FrameThatIsNone", kExport + "--marker_length 0.1 --frame sideways", 2,
           "--frame: 'sideways' is not a frame"},
          {"FrameRefusedBeforeTheWork", kRerun + " --frame reference_part", 2,
           "the layout names no reference_part"}};
}

std::vector<BadInput> DataWithoutAResult() {
  return {
      {"ALayoutOfOtherMarkersExported", kExport + "--layout_path @/own.yml", 1, "is in the layout",
       WriteOwnLayout("parts:\n  board: {markers: [40, 41]}\n")},
      {"ALayoutOfOtherMarkersAnalyzed",
       "shape_analyzer --shape_path @/workspace/shape --layout_path @/own.yml", 1,
       "is in the layout", WriteOwnLayout("parts:\n  board: {markers: [40, 41]}\n")},
      {"ALayoutOfAnotherDictionaryRegistered",
       "frame_registrator --database_path @/workspace/database.db --output_path @/new/seed "
       "--layout_path @/own.yml",
       2, "has dictionary=DICT_5X5_50 border_bits=1, but",
       [](const fs::path& dir) {
         WriteTextFile(dir / "own.yml", "dictionary: DICT_5X5_50\nmarker_length: 0.1\n");
       }},
      {"ADatabaseOfOtherNames",
       "bundle_adjuster --backend markers --marker_length 0.1 --output_path @/new/model "
       "--input_path @/workspace/sparse/0 --database_path @/workspace/database.db",
       2, "is not the one of",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db", "UPDATE images SET name = 'other_' || name");
       }},
      {"ADatabaseWithANameTwice",
       "frame_registrator --marker_length 0.1 --output_path @/new/seed --database_path "
       "@/workspace/database.db",
       2, "two images are named 1.png",
       [](const fs::path& dir) {
         RunSql(dir / "workspace/database.db",
                "CREATE TABLE loose AS SELECT * FROM images; DROP TABLE images; "
                "ALTER TABLE loose RENAME TO images; UPDATE images SET name = '1.png'");
       }},
      {"PointsAtOnePlaceForMarkers",
       "bundle_adjuster --backend markers --marker_length 0.1 --input_path @/model --output_path "
       "@/out",
       1, "lie at one place", PutPointsAtOnePlace},
      {"PointsAtOnePlaceForColmap", "bundle_adjuster --input_path @/model --output_path @/out", 1,
       "lie at one place", PutPointsAtOnePlace},
      {"AMarkerThatTheDictionaryDoesNotHave",
       "marker_importer --image_path @/images --camera_path @/camera.yml --layout_path @/own.yml "
       "--database_path @/new.db",
       2, "names marker 50, which the dictionary DICT_4X4_50 does not have",
       WriteOwnLayout("parts:\n  board: {markers: [49, 50]}\n")},
      {"ALengthOfAMarkerThatTheDictionaryDoesNotHave",
       "marker_importer --image_path @/images --camera_path @/camera.yml --layout_path @/own.yml "
       "--database_path @/new.db",
       2, "names marker 60", WriteOwnLayout("marker_lengths: {60: 0.2}\n")}};
}

}  // namespace

std::vector<BadInput> WishCases() {
  std::vector<BadInput> cases = Frames();
  for (const BadInput& more : DataWithoutAResult()) cases.push_back(more);
  return cases;
}

}  // namespace velamap
