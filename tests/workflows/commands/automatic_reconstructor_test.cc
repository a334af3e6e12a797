// The main job on real pictures: a workspace from photographs and from a video.

#include <algorithm>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reconstruct/model/model_io.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"
#include "tests/workflows/stylus_workspace.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
namespace fs = std::filesystem;

const fs::path kStylus = fs::path(VELAMAP_SOURCE_DIR) / "sample_project/stylus";

class AutomaticReconstructorTest : public ::testing::Test {
 protected:
  ProgramRun Run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (kStylus / "images").string(),
                                          "--camera_path",
                                          (kStylus / "camera.yml").string(),
                                          "--layout_path",
                                          (kStylus / "layout.yml").string(),
                                          "--workspace_path",
                                          workspace().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunVelamap(arguments);
  }

  fs::path workspace() const { return dir_ / "workspace"; }

  TempDir dir_;
};

TEST_F(AutomaticReconstructorTest, MakesTheWholeWorkspace) {
  const ProgramRun run = Run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(NumErrorLines(run.err), 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("verdict: "));
  for (const char* text :
       {"markers: 8 of 8, known to ", "size: ", " mm, known to ", "images: 16 of 16 used, 0."}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
  EXPECT_THAT(run.out, Not(HasSubstr("left out")));
  EXPECT_THAT(run.out, HasSubstr("look at: " + (workspace() / "report.html").string()));
  EXPECT_THAT(run.out, HasSubstr("in COLMAP: colmap gui --database_path " +
                                 (workspace() / "database.db").string() + " --image_path " +
                                 (workspace() / "images").string() + " --import_path " +
                                 (workspace() / "sparse/0").string() + "\n"));
  EXPECT_THAT(ListFolder(workspace()),
              ElementsAre("colmap.log", "database.db", "images", "registration.csv", "report.html",
                          "shape", "sparse", "timing.json", "velamap.log"));
  EXPECT_THAT(ListFolder(workspace() / "sparse"), ElementsAre("0", "seed"));
  EXPECT_THAT(ListFolder(workspace() / "shape"),
              IsSupersetOf({"markers.ply", "metrics.csv", "metrics.json", "scale.csv", "shape.csv",
                            "shape.json", "shape.ply"}));
  const auto json = nlohmann::json::parse(ReadFileBytes(workspace() / "shape/shape.json"));
  EXPECT_EQ(json.at("clip"), "images");
  EXPECT_EQ(json.at("num_markers"), 8);
  EXPECT_EQ(json.at("cameras").at(0).at("num_images"), 16);
  EXPECT_EQ(json.at("cameras").at(0).at("found_without_calibration"), false);
  std::vector<std::string> names;
  for (const ModelImage& image : ReadModel((workspace() / "sparse/0").string()).images) {
    names.push_back(image.name);
  }
  // COLMAP keeps the central image at the first place.
  const std::string central = ReadModel((workspace() / "sparse/seed").string()).images.at(0).name;
  EXPECT_EQ(names.at(0), central);
  EXPECT_THAT(run.err, HasSubstr("central frame " + central + ": "));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(ListFolder(workspace() / "images"), names);
}

TEST_F(AutomaticReconstructorTest, SecondRunReusesTheDatabaseAndGivesTheSameBytes) {
  CopyStylusWorkspace(workspace());
  const auto read_all = [this] {
    std::string bytes;
    for (const char* file : {"shape/shape.csv", "shape/shape.ply", "shape/markers.ply",
                             "sparse/0/points3D.bin", "sparse/seed/images.bin"}) {
      bytes += ReadFileBytes(workspace() / file);
    }
    return bytes;
  };
  const std::string first = read_all();
  const ProgramRun second = Run({"--summary", "json"});
  ASSERT_EQ(second.exit_code, 0) << second.err;
  const auto summary = nlohmann::json::parse(second.out);
  EXPECT_EQ(summary.at("num_images_used"), 16);
  EXPECT_EQ(summary.at("num_markers"), 8);
  EXPECT_GT(summary.at("scale_sigma_percent"), 0.0);
  EXPECT_EQ(summary.at("verdict_reasons").empty(), summary.at("verdict") == "good");
  const auto verdict =
      nlohmann::json::parse(ReadFileBytes(workspace() / "shape/shape.json")).at("verdict");
  EXPECT_EQ(verdict.at("level"), summary.at("verdict"));
  EXPECT_EQ(verdict.at("reasons").size(), summary.at("verdict_reasons").size());
  EXPECT_EQ(summary.at("workspace_path"), workspace().string());
  EXPECT_THAT(second.err, HasSubstr("0 images added, 16 were in the database before"));
  EXPECT_EQ(read_all(), first);
}

TEST_F(AutomaticReconstructorTest, WhatIsSentAroundNamesNoFolderAndRunsNoScript) {
  const fs::path secret = dir_ / "Jo Doe";
  const fs::path images = secret / "<script>alert(1)<" / "script>";
  fs::create_directories(images.parent_path());
  fs::copy(kStylus / "images", images);
  WriteTextFile(images / "broken.jpg", "no picture");
  const std::vector<std::string> arguments = {
      "automatic_reconstructor", "--image_path",         images.string(),
      "--camera_path",           kStylus / "camera.yml", "--layout_path",
      kStylus / "layout.yml",    "--workspace_path",     secret / "workspace"};
  const auto texts = [&] {
    std::string all;
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(secret / "workspace")) {
      const bool is_sent = entry.is_regular_file() && entry.path().filename() != "database.db";
      if (is_sent) all += ReadFileBytes(entry.path());
    }
    return all;
  };
  const ProgramRun run = RunVelamap(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr(images.string()));  // the terminal is the user's own
  const std::string without = texts();
  for (const std::string& folder : {dir_.path().string(), kStylus.string(), std::string("Jo Doe"),
                                    fs::temp_directory_path().string() + "/"}) {
    EXPECT_EQ(without.find(folder), std::string::npos)
        << folder << ": " << without.substr(without.find(folder) - 100, 200);
  }
  EXPECT_THAT(without, HasSubstr("--camera_path camera.yml"));
  const auto clip = [&] {
    return nlohmann::json::parse(ReadFileBytes(secret / "workspace/shape/shape.json")).at("clip");
  };
  EXPECT_EQ(clip(), images.filename().string());
  EXPECT_EQ(ReadFileBytes(secret / "workspace/report.html").find("<script>alert"),
            std::string::npos);
  std::vector<std::string> asked = arguments;
  asked.insert(asked.end(), {"--full_paths", "1"});
  ASSERT_EQ(RunVelamap(asked).exit_code, 0);
  const std::string with = texts();
  EXPECT_EQ(clip(), images.string());
  EXPECT_THAT(with, HasSubstr("--camera_path " + (kStylus / "camera.yml").string()));
  EXPECT_THAT(ReadFileBytes(secret / "workspace/report.html"),
              HasSubstr((kStylus / "camera.yml").string()));
}

TEST_F(AutomaticReconstructorTest, OtherDetectionOptionsNeedANewDatabase) {
  CopyStylusWorkspace(workspace());
  const ProgramRun quiet = Run({"--log_level", "error"});
  ASSERT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.err, "");
  const std::string before = ReadFileBytes(workspace() / "shape/shape.csv");
  const ProgramRun run = Run({"--ArucoDetection.corner_refinement", "none"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(NumErrorLines(run.err), 1);
  EXPECT_THAT(run.err, HasSubstr("--import_anew 1"));
  EXPECT_EQ(ReadFileBytes(workspace() / "shape/shape.csv"), before);
}

TEST_F(AutomaticReconstructorTest, AWrongSurfaceOptionKeepsTheOldResult) {
  CopyStylusWorkspace(workspace());
  const auto result = [this] {
    std::map<std::string, std::string> bytes;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(workspace())) {
      const bool is_log = entry.path().extension() == ".log";
      if (entry.is_regular_file() && !is_log) bytes[entry.path()] = ReadFileBytes(entry.path());
    }
    bytes.erase(workspace() / "database.db");  // which stays usable, not equal
    return bytes;
  };
  const std::map<std::string, std::string> before = result();
  EXPECT_EQ(before.count(workspace() / "shape/freeform.ply"), 1u);
  for (const char* format : {"text", "json"}) {
    const ProgramRun run = Run({"--Surface.edge_length", "0.001", "--summary", format});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("error: --Surface.edge_length: 0.001 mm would need"));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(result(), before);
  }
  // Where there is no earlier result, everything but the surface is written.
  for (const char* name : {"shape", "sparse", "report.html"}) fs::remove_all(workspace() / name);
  const ProgramRun run = Run({"--Surface.edge_length", "0.001"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(ListFolder(workspace() / "sparse"), ElementsAre("0", "seed"));
  EXPECT_THAT(ListFolder(workspace() / "shape"), IsSupersetOf({"shape.csv", "shape.json"}));
  EXPECT_TRUE(fs::exists(workspace() / "report.html"));
}

TEST_F(AutomaticReconstructorTest, FailureOfColmapKeepsTheOldResult) {
  CopyStylusWorkspace(workspace());
  const std::string before = ReadFileBytes(workspace() / "sparse/0/points3D.bin");
  WriteTextFile(dir_ / "colmap",
                "#!/bin/sh\nfor a in \"$@\"; do [ \"$a\" = -h ] && exec colmap \"$@\"; done\n"
                "kill -9 $$\n");
  fs::permissions(dir_ / "colmap", fs::perms::owner_all);
  const ProgramRun run = Run({"--colmap_path", (dir_ / "colmap").string()});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
  EXPECT_EQ(ReadFileBytes(workspace() / "sparse/0/points3D.bin"), before);
  EXPECT_THAT(ListFolder(workspace()),
              ElementsAre("colmap.log", "database.db", "images", "registration.csv", "report.html",
                          "shape", "sparse", "timing.json", "velamap.log"));
  EXPECT_THAT(ReadFileBytes(workspace() / "velamap.log"), HasSubstr("error: "));
}

}  // namespace
}  // namespace velamap
