// A result is of the data it was asked for.

#include <stdexcept>

#include <fmt/format.h>

#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

const std::vector<std::string> kLog = {"workspace/velamap.log"};

// Another picture in the place of a photograph.
void SwapPhotographs(const fs::path& dir) {
  fs::rename(dir / "images/1.png", dir / "images/swap.png");
  fs::rename(dir / "images/2.png", dir / "images/1.png");
  fs::rename(dir / "images/swap.png", dir / "images/2.png");
}

void RunGood(const fs::path& dir, const std::string& command) {
  const ProgramRun run = RunVelamap(ArgumentsIn(dir, command));
  if (run.exit_code != 0) throw std::runtime_error(run.err);
}

const std::string kImportClipAgain =
    "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path @/layout.yml "
    "--database_path @/new.db";

const std::string kImportNoVideo =
    "marker_importer --image_path @/video.mp4 --camera_path @/camera.yml --layout_path "
    "@/layout.yml --database_path @/new.db";

std::vector<BadInput> ChangedSourcesOfAWorkspace() {
  const std::string of_video =
      "automatic_reconstructor --image_path @/clip.avi --camera_path @/camera.yml --layout_path "
      "@/layout.yml --backend markers --workspace_path @/workspace";
  return {{"OtherPhotographsOfTheSameNames", kRerun, 2, "1.png has changed since it was imported",
           SwapPhotographs, kLog},
          {"OtherPhotographsInAnotherFolder",
           "automatic_reconstructor --image_path @/other --camera_path @/camera.yml --layout_path "
           "@/layout.yml --backend markers --workspace_path @/workspace",
           2, "1.png has changed since it was imported",
           [](const fs::path& dir) {
             fs::copy(dir / "images", dir / "other");
             fs::copy(dir / "grey/a.png", dir / "other/1.png",
                      fs::copy_options::overwrite_existing);
           },
           kLog},
          {"APhotographDeleted", kRerun, 2, "holds 4.png, which is not in",
           [](const fs::path& dir) { fs::remove(dir / "images/4.png"); }, kLog},
          {"PhotographsOfOtherNames",
           "automatic_reconstructor --image_path @/grey --camera_path @/camera.yml --layout_path "
           "@/layout.yml --backend markers --workspace_path @/workspace",
           2,
           "holds 1.png, which is not in",
           {},
           kLog},
          {"AVideoInTheWorkspaceOfPhotographs", of_video, 2, "was made from photographs", {}, kLog},
          {"FramesThatTheOptionsLeaveOut",
           of_video + "2 --Video.frame_step 2",
           2,
           "holds 2 frames, such as frame_000001.jpg",
           [of_video](const fs::path& dir) { RunGood(dir, of_video + "2"); },
           {"workspace2/velamap.log"}}};
}

std::vector<BadInput> ChangedSourcesOfADatabase() {
  return {
      {"AnotherVideo", kImportClipAgain, 2, "another video than",
       [](const fs::path& dir) {
         RunGood(dir, kImportClipAgain);
         RunSql(dir / "new.db", "UPDATE marker_sources SET size = size + 1, path_hash = 1");
       }},
      {"AVideoWithOtherOptions", kImportClipAgain + " --ArucoDetection.corner_refinement subpix", 2,
       "was made with other detection options", [](const fs::path& dir) { RunGood(dir, kImport); }},
      {"ImportedAnewFromNoVideo", kImportNoVideo + " --import_anew 1", 2, "video.mp4",
       [](const fs::path& dir) {
         RunGood(dir, kImportClipAgain);
         WriteTextFile(dir / "video.mp4", "no video");
       }},
      {"ImportedAnewOverADatabaseOfOthers", kImportClipAgain + " --import_anew 1", 2, "new.db",
       [](const fs::path& dir) { RunSql(dir / "new.db", "CREATE TABLE notes(text TEXT)"); }},
      {"AVideoThatWasChanged", kImportClipAgain, 2, "the video before it was changed",
       [](const fs::path& dir) {
         RunGood(dir, kImportClipAgain);
         WriteTextFile(dir / "clip.avi", ReadFileBytes(dir / "clip.avi") + "more");
       }},
      {"APhotographDeletedFromTheFolderOfADatabase", kImport, 2, "holds 4.png, which is not in",
       [](const fs::path& dir) {
         RunGood(dir, kImport);
         fs::remove(dir / "images/4.png");
       }},
      {"AnotherFolderWithTheSameNames",
       "marker_importer --image_path @/other --camera_path @/camera.yml --layout_path "
       "@/layout.yml --database_path @/new.db",
       2, "holds another picture of the name 1.png",
       [](const fs::path& dir) {
         RunGood(dir, kImport);
         fs::create_directory(dir / "other");
         fs::copy(dir / "images/2.png", dir / "other/1.png");
       }},
      {"APhotographReplacedInTheFolderOfADatabase", kImport, 2, "has changed since it was imported",
       [](const fs::path& dir) {
         RunGood(dir, kImport);
         SwapPhotographs(dir);
       }}};
}

// Parts of a video that are not what the whole needs.
std::vector<BadInput> Parts() {
  const std::string merge =
      "database_merger --layout_path @/layout.yml --output_path @/merged.db --database_paths ";
  const auto part = [](int number, const std::string& more = "") {
    return fmt::format(
        "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path "
        "@/layout.yml --video_part {0}/2 --database_path @/{0}.db {1}",
        number, more);
  };
  const auto import_first = [part](const fs::path& dir) { RunGood(dir, part(1)); };
  const auto import_both = [part](const fs::path& dir) {
    for (const int number : {1, 2}) RunGood(dir, part(number));
  };
  return {
      {"APartOfPhotographs", kImport + " --video_part 1/2", 2, "photographs have no parts"},
      {"APartBeyondTheLast", kImportClipAgain + " --video_part 3/2", 2,
       "--video_part: '3/2' is not a part"},
      {"APartInWords", kImportClipAgain + " --video_part second", 2,
       "--video_part: 'second' is not a part"},
      {"AnotherPartInADatabase",
       "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path "
       "@/layout.yml --video_part 2/2 --database_path @/1.db",
       2, "holds part 1/2", import_first},
      {"AWholeImportInTheDatabaseOfAPart",
       "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path "
       "@/layout.yml --database_path @/1.db",
       2, "holds part 1/2", import_first},
      {"APartInTheDatabaseOfAWholeImport", kImportClipAgain + " --video_part 1/2", 2,
       "holds the import of a whole source",
       [](const fs::path& dir) { RunGood(dir, kImportClipAgain); }},
      {"AWholeImportToMerge", merge + "@/workspace/database.db", 2, "holds no part of a video"},
      {"AMissingPart", merge + "@/1.db", 2, "part 2/2 is missing", import_first},
      {"APartNamedTwice", merge + "@/1.db,@/2.db,@/1.db", 2, "name each part once", import_both},
      {"PartsOfOtherOptions", merge + "@/1.db,@/2.db", 2, "other detection options",
       [part, import_first](const fs::path& dir) {
         import_first(dir);
         RunGood(dir, part(2, "--ArucoDetection.corner_refinement subpix"));
       }},
      {"PartsMergedWithAnotherLayout",
       "database_merger --dictionary DICT_4X4_100 --marker_length 0.1 --output_path @/merged.db "
       "--database_paths @/1.db,@/2.db",
       2, "--layout_path: not the layout", import_both},
      {"PartsMergedOverOne",
       "database_merger --layout_path @/layout.yml --output_path @/2.db --database_paths "
       "@/1.db,@/2.db",
       2, "is also the --database_paths", import_both},
      {"PartsMergedOverAPhotograph",
       "database_merger --layout_path @/layout.yml --output_path @/images/1.png --database_paths "
       "@/1.db,@/2.db",
       2, "not an SQLite database", import_both}};
}

// What camera and print do to edges, as the database says.
std::vector<BadInput> ImageFormations() {
  const std::vector<std::pair<std::string, std::string>> bad_values = {
      {"gamma", "'text'"},
      {"gamma", "0"},
      {"gamma", "-1"},
      {"gamma", "1e9"},
      {"gamma", "9e999"},
      {"s_amplitude", "1"},
      {"sharpening", "-1"},
      {"sharpening", "1e9"},
      {"sharpening_radius_px", "0"},
      {"is_inverted", "7"},
      {"noise_gray", "-1"},
      {"inset_sigma_px", "'text'"},
      {"ink_spread_mm", "0.5"},
      {"edge_shift_blurs", "9"},
      {"outline_shift_blurs", "9"},
      {"outline_corner_weight", "2"},
      {"halo", "1"},
      {"halo_radius_px", "0"}};
  std::vector<BadInput> cases;
  for (const auto& [column, value] : bad_values) {
    cases.push_back({fmt::format("ImageFormation{}", cases.size()), kRerun, 2,
                     "table image_formation: " + column,
                     [column = column, value = value](const fs::path& dir) {
                       RunSql(dir / "workspace/database.db",
                              "UPDATE image_formation SET " + column + " = " + value);
                     },
                     kLog});
  }
  // NULL, which SQLite stores for a NaN, where no constraint forbids it.
  cases.push_back({"ImageFormationOfNothing",
                   "bundle_adjuster --backend markers --marker_length 0.1 --input_path "
                   "@/workspace/sparse/seed --output_path @/out --database_path "
                   "@/workspace/database.db",
                   2, "table image_formation: gamma", [](const fs::path& dir) {
                     RunSql(dir / "workspace/database.db",
                            "CREATE TABLE other AS SELECT * FROM image_formation;"
                            "DROP TABLE image_formation;"
                            "ALTER TABLE other RENAME TO image_formation;"
                            "UPDATE image_formation SET gamma = NULL");
                   }});
  return cases;
}

}  // namespace

std::vector<BadInput> SourceCases() {
  std::vector<BadInput> cases = ChangedSourcesOfAWorkspace();
  for (const auto& more : {ChangedSourcesOfADatabase(), Parts(), ImageFormations()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
