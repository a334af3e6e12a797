// The column duration_s of a data set, which workflows/dataset/run_job.py takes from a database.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/database/colmap_database.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

// Video frames at 30 per second, some of which hold rejected markers only, as an import leaves
// frames whose markers look the same when turned. Returns what run_job.py calls their duration.
std::string DurationText(int num_frames, const std::vector<int>& rejected_frames) {
  SyntheticSceneOptions options;
  options.num_rows = options.num_columns = 2;
  options.num_frames = num_frames;
  SyntheticScene scene = MakeSyntheticScene(options);
  for (const int idx : rejected_frames) {
    FrameDetections& frame = scene.frames[static_cast<std::size_t>(idx)];
    for (const MarkerDetection& marker : frame.markers) {
      frame.rejected.push_back({marker, "looks the same when turned"});
    }
    frame.markers.clear();
  }
  const TempDir dir;
  const std::string path = (dir / "clip.db").string();
  {
    ColmapDatabase database(path, ColmapDatabase::Mode::kReadWriteCreate);
    ColmapDatabase::Transaction transaction(&database);
    const CameraId camera_id = database.AddCamera(scene.camera);
    for (const FrameDetections& frame : scene.frames) database.AddImage(camera_id, frame, "test");
    transaction.Commit();
  }
  const ProgramRun run = RunProgram(
      "/usr/bin/env",
      {"python3", "-B", "-c",
       "import sys; sys.path.insert(0, sys.argv[1]); from pathlib import Path; import run_job; "
       "duration = run_job.duration_s(Path(sys.argv[2])); "
       "print('none' if duration is None else f'{duration:.4f}')",
       std::string(VELAMAP_SOURCE_DIR) + "/workflows/dataset", path});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.out;
}

TEST(DatasetDuration, CountsOnlyFramesWithUsedMarkers) {
  EXPECT_EQ(DurationText(12, {}), "0.4000\n");  // 12 / 30, the last frame's own time included
  EXPECT_EQ(DurationText(12, {0, 1, 5, 11}), "0.3000\n");
  EXPECT_EQ(DurationText(3, {0, 2}), "none\n");
}

}  // namespace
}  // namespace velamap
