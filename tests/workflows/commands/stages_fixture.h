// A folder and a synthetic scene for the single commands, without pictures.

#pragma once

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/database/colmap_database.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {

namespace fs = std::filesystem;

inline SyntheticScene MakeScene() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 8;
  options.video = false;
  return MakeSyntheticScene(options);
}

// Keeps the first `num_frames` frames, and of their markers those that `keep_id` accepts by the
// index of the frame and the id.
template <typename KeepId>
void WriteDatabase(const SyntheticScene& scene, const fs::path& path, int num_frames,
                   KeepId keep_id) {
  ColmapDatabase database(path.string(), ColmapDatabase::Mode::kReadWriteCreate);
  const CameraId camera_id = database.AddCamera(scene.camera);
  for (int i = 0; i < num_frames; ++i) {
    FrameDetections detections = scene.frames[static_cast<std::size_t>(i)];
    auto& markers = detections.markers;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [&](const auto& m) { return !keep_id(i, m.marker_id); }),
                  markers.end());
    database.AddImage(camera_id, detections, "test");
  }
}

inline bool All(int, int) { return true; }

class StagesTest : public ::testing::Test {
 protected:
  ProgramRun Register(const ProgramLimits& limits = {}) {
    return RunVelamap({"frame_registrator", "--database_path", path("database.db"),
                       "--marker_length", "0.1", "--output_path", path("sparse/seed")},
                      limits);
  }

  ProgramRun Export(const ProgramLimits& limits = {}) {
    return RunVelamap({"shape_exporter", "--input_path", path("model"), "--marker_length", "0.1",
                       "--shape_path", path("shape"), "--output_path", path("metric")},
                      limits);
  }

  void ExpectError(const ProgramRun& run, int exit_code, const std::string& expected) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, ::testing::HasSubstr("error: "));
    EXPECT_THAT(run.err, ::testing::HasSubstr(expected));
    EXPECT_EQ(NumErrorLines(run.err), 1) << run.err;
    EXPECT_EQ(run.out, "");
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  const SyntheticScene scene_ = MakeScene();
  TempDir dir_;
};

}  // namespace velamap
