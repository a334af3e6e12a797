// No file of the user is ever lost.

#include <memory>

#include "importer/base/file_lock.h"
#include "tests/bad_input/sandbox.h"

namespace velamap {
namespace {

const std::string kAnalyze = "shape_analyzer --marker_length 0.1 --shape_path ";
const std::string kShape = "@/workspace/shape";
const std::string kSeed = "@/workspace/sparse/seed";
const std::string kImportClip =
    "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path @/layout.yml "
    "--database_path @/clip.db --frame_output_path @/frames";

// A file of the user at this place.
std::function<void(const fs::path&)> Put(const std::string& name) {
  return [name](const fs::path& dir) {
    fs::create_directories((dir / name).parent_path());
    WriteTextFile(dir / name, "of the user");
  };
}

std::vector<BadInput> ShapesOverInputs() {
  return {
      {"CsvOverTheShape", kAnalyze + kShape + "/shape.csv --csv_path " + kShape + "/shape.csv", 2,
       "is also the --shape_path"},
      {"CsvOverTheShapeOfAFolder", kAnalyze + kShape + " --csv_path " + kShape + "/shape.csv", 2,
       "is also the --shape_path"},
      {"CsvOverTheLayout",
       "shape_analyzer --shape_path " + kShape +
           " --layout_path @/layout.yml --csv_path @/layout.yml",
       2, "is also the --layout_path"},
      {"CsvOverTheDictionaryOfTheLayout",
       "shape_analyzer --shape_path " + kShape +
           " --layout_path @/own.yml --csv_path @/dictionary.yml",
       2, "is also the --layout_path",
       [](const fs::path& dir) {
         WriteTextFile(dir / "dictionary.yml", "dictionary");
         WriteTextFile(dir / "own.yml", "dictionary: dictionary.yml\nmarker_length: 0.1\n");
       }},
      {"CsvThroughASymbolicLink", kAnalyze + kShape + " --csv_path @/link", 2,
       "is also the --shape_path",
       [](const fs::path& dir) { fs::create_symlink("workspace/shape/shape.csv", dir / "link"); }},
      {"CsvThroughAHardLink", kAnalyze + kShape + " --csv_path @/hard", 2,
       "is also the --shape_path",
       [](const fs::path& dir) {
         fs::create_hard_link(dir / "workspace/shape/shape.csv", dir / "hard");
       }},
      {"CsvThroughAFolderLink", kAnalyze + kShape + " --csv_path @/folder/shape.csv", 2,
       "is also the --shape_path",
       [](const fs::path& dir) { fs::create_symlink("workspace/shape", dir / "folder"); }},
      {"CsvOverTheModel",
       kAnalyze + kShape +
           " --input_path @/workspace/sparse/0 --csv_path "
           "@/workspace/sparse/0/points3D.bin",
       2, "is also the --shape_path; give another"},
      {"CsvOverTheProjectFile", "shape_analyzer --project_path @/p.ini --csv_path @/p.ini", 2,
       "is also the --project_path",
       [](const fs::path& dir) {
         WriteTextFile(dir / "p.ini",
                       "marker_length=0.1\nshape_path=" + (dir / "workspace/shape").string());
       }},
      {"JsonOverTheCsv", kAnalyze + kShape + " --csv_path @/a --json_path @/grey/../a", 2,
       "is also the --csv_path"},
      {"ComparisonOverTheReference",
       "shape_comparer --shape_path " + kShape + " --reference_path " + kShape +
           "/shape.csv --output_path " + kShape + "/shape.csv",
       2, "is also the --shape_path; give another"},
      {"ComparisonOverTheUncertainty",
       "shape_comparer --shape_path " + kShape + " --reference_path " + kShape +
           " --csv_path @/workspace/sparse/0/uncertainty.bin",
       2, "is also the --shape_path; give another"}};
}

std::vector<BadInput> ModelsAndDatabasesOverInputs() {
  return {
      {"LogOverTheDatabase",
       "bundle_adjuster --input_path " + kSeed +
           " --output_path @/out --database_path @/workspace/database.db --log_path "
           "@/workspace/database.db",
       2, "is also the --database_path; give another"},
      {"ModelOverItself", "bundle_adjuster --input_path " + kSeed + " --output_path " + kSeed, 2,
       "is also the --input_path"},
      {"ModelOverTheFolderThatHoldsIt",
       "bundle_adjuster --input_path " + kSeed + " --output_path @/workspace/sparse", 2,
       "replaced as a whole"},
      {"LogInTheModel",
       "bundle_adjuster --input_path " + kSeed + " --output_path @/out --log_path @/out/log", 2,
       "replaced as a whole"},
      {"MetricModelOverItself",
       "shape_exporter --marker_length 0.1 --input_path " + kSeed + " --output_path " + kSeed, 2,
       "is also the --input_path"},
      {"ShapeOverTheModel",
       "shape_exporter --marker_length 0.1 --input_path " + kSeed + " --shape_path " + kSeed, 2,
       "is also the --input_path"},
      {"ShapeInTheMetricModel",
       "shape_exporter --marker_length 0.1 --input_path " + kSeed +
           " --output_path @/out --shape_path @/out/shape",
       2, "replaced as a whole"},
      {"ShapeOverTheEdges",
       "shape_exporter --marker_length 0.1 --input_path " + kSeed +
           " --shape_path @/mine --Surface.edges_path @/mine/edges.csv",
       2, "replaced as a whole", Put("mine/edges.csv")},
      {"TableOverTheDatabase",
       "frame_registrator --marker_length 0.1 --database_path @/workspace/database.db "
       "--output_path @/out --registration_path @/workspace/database.db",
       2, "is also the --database_path"},
      {"SweepOverTheDatabase",
       "central_frame_sweeper --marker_length 0.1 --database_path @/workspace/database.db "
       "--output_path @/workspace/database.db",
       2, "is also the --database_path"},
      {"DatabaseOverTheLayout",
       "marker_importer --image_path @/images --camera_path @/camera.yml --layout_path "
       "@/layout.yml --database_path @/layout.yml",
       2, "is also the --layout_path"},
      {"DatabaseOverAPhotograph",
       "marker_importer --image_path @/images --camera_path @/camera.yml --layout_path "
       "@/layout.yml --database_path @/images/1.png",
       2, "is also the --image_path"},
      {"DatabaseOverTheVideo",
       "marker_importer --image_path @/clip.avi --camera_path @/camera.yml --layout_path "
       "@/layout.yml --database_path @/clip.avi",
       2, "is also the --image_path"},
      {"PriorShapeOfTheSameWorkspace", kRerun + " --prior_shape_path " + kShape, 2,
       "--prior_shape_path"},
      {"CameraOfTheSameWorkspace",
       "automatic_reconstructor --image_path @/images --camera_path "
       "@/workspace/sparse/0/cameras.txt --layout_path @/layout.yml --workspace_path @/workspace",
       2, "--camera_path"}};
}

std::vector<BadInput> FoldersOfOthers() {
  return {
      {"NotesInSparse", kRerun, 2, "sparse: the output folder holds notes.txt",
       Put("workspace/sparse/notes.txt")},
      {"AModelOfTheGuiInSparse", kRerun, 2, "holds cameras.bin",
       Put("workspace/sparse/1/cameras.bin")},
      {"AModelOfTheGuiOverOurs", kRerun, 2, "points3D.bin, which was changed",
       Put("workspace/sparse/0/points3D.bin")},
      {"NotesInTheModel", kRerun, 2, "holds notes.txt", Put("workspace/sparse/0/notes.txt")},
      {"AStrayFileInTheShape", kRerun, 2, "holds stray.txt", Put("workspace/shape/stray.txt")},
      {"AHiddenFileInTheShape", kRerun, 2, "holds .stray", Put("workspace/shape/.stray")},
      {"AnEditedShape", kRerun, 2, "shape.csv, which was changed",
       Put("workspace/shape/shape.csv")},
      {"AFileInPlaceOfTheShape", kRerun, 2, "is not a folder",
       [](const fs::path& dir) {
         fs::remove_all(dir / "workspace/shape");
         WriteTextFile(dir / "workspace/shape", "of the user");
       }},
      {"ModelOverAFolderOfTheUser",
       "bundle_adjuster --input_path " + kSeed + " --output_path @/home", 2, "holds thesis.tex",
       Put("home/thesis.tex")},
      {"ModelOverAModelOfAnother",
       "bundle_adjuster --input_path " + kSeed + " --output_path @/theirs", 2, "holds cameras.bin",
       Put("theirs/cameras.bin")},
      {"ShapeOverAFolderOfTheUser",
       "shape_exporter --marker_length 0.1 --input_path " + kSeed + " --shape_path @/home", 2,
       "holds shape.csv", Put("home/shape.csv")},
      {"ATableOfTheUserInTheWorkspace", kRerun, 2,
       "registration.csv would be replaced, but velamap did not write it",
       Put("workspace/registration.csv")},
      {"AnEditedReport", kRerun, 2, "report.html would be replaced, but was changed",
       [](const fs::path& dir) {
         Replace(dir / "workspace/report.html", "</title>", "!</title>");
       }},
      {"ATableOfTheUserBesideTheSeed",
       "frame_registrator --database_path @/workspace/database.db --marker_length 0.1 "
       "--output_path @/home/seed",
       2, "registration.csv would be replaced", Put("home/registration.csv")},
      {"APageOfTheUserBesideTheCamera",
       "camera_calibrator --image_path @/images --layout_path @/layout.yml --output_path "
       "@/home/camera.yml",
       2, "camera.html would be replaced", Put("home/camera.html")},
      {"FramesOverPicturesOfTheUser", kImportClip, 2, "frame_000002.jpg",
       Put("frames/frame_000002.jpg")},
      {"AWorkspaceThatIsNone", kRerun + "2", 2, "holds thesis.tex", Put("workspace2/thesis.tex")}};
}

// Names that lead out of the workspace.
std::vector<BadInput> NamesThatLeadOut() {
  const auto rename = [](const std::string& name) {
    return [name](const fs::path& dir) {
      WriteTextFile(dir / "victim.jpg", "of the user");
      RunSql(dir / "workspace/database.db",
             "UPDATE images SET name = '" + name + "' WHERE name = '1.png'");
    };
  };
  const auto rename_in_model = [](const fs::path& dir) {
    fs::create_directory(dir / "model");
    for (const char* file : {"cameras.txt", "images.txt", "points3D.txt"}) {
      fs::copy(dir / "workspace/sparse/0" / file, dir / "model" / file);
    }
    Replace(dir / "model/images.txt", "1.png", "../../victim.jpg");
  };
  return {{"ImageNameAboveTheDatabase",
           kRerun,
           2,
           "leads out",
           rename("../../victim.jpg"),
           {"workspace/velamap.log"}},
          {"ImageNameAtTheRoot",
           kRerun,
           2,
           "leads out",
           rename("/victim.jpg"),
           {"workspace/velamap.log"}},
          {"ImageNameThatIsEmpty", kRerun, 2, "leads out", rename(""), {"workspace/velamap.log"}},
          {"ImageNameAboveTheDatabaseRegistered",
           "frame_registrator --marker_length 0.1 --database_path @/workspace/database.db "
           "--output_path @/out",
           2, "leads out", rename("a/../../victim.jpg")},
          {"ImageNameAboveTheModel",
           "bundle_adjuster --backend markers --marker_length 0.1 --input_path @/model "
           "--output_path @/out",
           2, "leads out", rename_in_model},
          {"ImageNameAboveTheModelExported",
           "shape_exporter --marker_length 0.1 --input_path @/model --shape_path @/out", 2,
           "leads out", rename_in_model}};
}

// One at a time. The lock is held until the next case.
std::vector<BadInput> SecondRuns() {
  const auto hold = [](const std::string& name) {
    return [name](const fs::path& dir) {
      static std::unique_ptr<FileLock> lock;
      lock.reset();
      lock = std::make_unique<FileLock>(dir / name, "test");
    };
  };
  return {
      {"ASecondRunInTheWorkspace", kRerun, 2, "another velamap process is using it (since",
       hold("workspace/.velamap.lock")},
      {"ASecondRunInANewWorkspace", kRerun + "2", 2, "another velamap process is using it (since",
       [hold](const fs::path& dir) {
         fs::create_directory(dir / "workspace2");
         hold("workspace2/.velamap.lock")(dir);
       }},
      {"AnImportIntoTheSameDatabase", kImport, 2, "another velamap process is using it (since",
       hold(".new.db.lock")},
      {"AFileOfTheUserInPlaceOfTheLock", kImport, 2, ".new.db.lock: velamap did not write this",
       Put(".new.db.lock")},
      {"AFileOfTheUserInPlaceOfTheLockOfTheWorkspace", kRerun, 2,
       ".velamap.lock: velamap did not write this", Put("workspace/.velamap.lock")},
      {"AnImportIntoTheDatabaseOfTheWorkspace",
       kRerun,
       2,
       "another velamap process is using it (since",
       hold("workspace/.database.db.lock"),
       {"workspace/velamap.log"}}};
}

}  // namespace

std::vector<BadInput> OutputCases() {
  std::vector<BadInput> cases = ShapesOverInputs();
  for (const auto& more :
       {ModelsAndDatabasesOverInputs(), FoldersOfOthers(), NamesThatLeadOut(), SecondRuns()}) {
    cases.insert(cases.end(), more.begin(), more.end());
  }
  return cases;
}

}  // namespace velamap
