// --preset thesis on real pictures: the same as the options spelled out, in one call or in steps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const std::vector<std::string> kSpelledOut = {"--ArucoDetection.search",
                                              "exhaustive",
                                              "--ArucoDetection.corner_refinement",
                                              "subpix",
                                              "--Registration.method",
                                              "thesis",
                                              "--Registration.thesis_variant",
                                              "exact",
                                              "--Registration.num_frames",
                                              "20",
                                              "--Registration.skip",
                                              "10",
                                              "--Registration.neighborhood",
                                              "5",
                                              "--Registration.ransac_max_error",
                                              "0.1",
                                              "--Registration.frequency_threshold",
                                              "0.3",
                                              "--Registration.num_mean_iterations",
                                              "30",
                                              "--Registration.mean_sigma",
                                              "0.6",
                                              "--backend",
                                              "colmap",
                                              "--BundleAdjustment.remove_outliers",
                                              "0",
                                              "--scale_by",
                                              "mean_side"};

class ThesisPresetTest : public ::testing::Test {
 protected:
  static fs::path BoardFile(const std::string& name) {
    return fs::path(VELAMAP_SOURCE_DIR) / "tests/data/board_video" / name;
  }

  ProgramRun Run(std::vector<std::string> arguments, const std::vector<std::string>& more) const {
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = RunVelamap(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run;
  }

  // Reconstructs a hand-held video of a board and returns what the program said.
  ProgramRun Reconstruct(const std::string& workspace, const std::vector<std::string>& more) const {
    return Run({"automatic_reconstructor", "--image_path", BoardFile("cam_0.mp4"), "--camera_path",
                BoardFile("camera.yml"), "--layout_path", BoardFile("layout.yml"),
                "--ArucoDetection.inverted", "1", "--workspace_path", Path(workspace)},
               more);
  }

  std::string Path(const std::string& name) const { return (dir_ / name).string(); }
  std::string Bytes(const std::string& name) const { return ReadFileBytes(dir_ / name); }

  TempDir dir_;
};

TEST_F(ThesisPresetTest, IsTheSameAsTheOptionsSpelledOut) {
  const ProgramRun preset = Reconstruct("preset", {"--preset", "thesis"});
  EXPECT_THAT(preset.err,
              HasSubstr("preset thesis sets --ArucoDetection.corner_refinement subpix"));
  EXPECT_THAT(Bytes("preset/velamap.log"), HasSubstr("--scale_by mean_side"));
  Reconstruct("spelled_out", kSpelledOut);
  for (const char* file : {"shape/shape.csv", "sparse/seed/images.txt", "sparse/0/points3D.txt"}) {
    EXPECT_FALSE(Bytes(std::string("preset/") + file).empty()) << file;
    EXPECT_EQ(Bytes(std::string("preset/") + file), Bytes(std::string("spelled_out/") + file))
        << file;
  }
  Reconstruct("default", {});
  EXPECT_NE(Bytes("default/shape/shape.csv"), Bytes("preset/shape/shape.csv"));
}

TEST_F(ThesisPresetTest, IsTheSameInSteps) {
  Reconstruct("at_once", {"--preset", "thesis"});
  const std::vector<std::string> preset = {"--preset", "thesis"};
  const std::string layout = BoardFile("layout.yml");
  Run({"marker_importer", "--image_path", BoardFile("cam_0.mp4"), "--camera_path",
       BoardFile("camera.yml"), "--layout_path", layout, "--ArucoDetection.inverted", "1",
       "--database_path", Path("database.db")},
      preset);
  Run({"frame_registrator", "--database_path", Path("database.db"), "--layout_path", layout,
       "--output_path", Path("seed")},
      preset);
  Run({"bundle_adjuster", "--input_path", Path("seed"), "--output_path", Path("adjusted")}, preset);
  Run({"shape_exporter", "--input_path", Path("adjusted"), "--layout_path", layout, "--shape_path",
       Path("shape")},
      preset);
  EXPECT_EQ(Bytes("shape/shape.csv"), Bytes("at_once/shape/shape.csv"));
}

TEST_F(ThesisPresetTest, WhatIsGivenBesideItWins) {
  const ProgramRun run =
      Reconstruct("edge", {"--preset", "thesis", "--ArucoDetection.corner_refinement", "edge"});
  EXPECT_THAT(run.err, HasSubstr("given instead: --ArucoDetection.corner_refinement edge"));
  Reconstruct("subpix", {"--preset", "thesis"});
  EXPECT_NE(Bytes("edge/shape/shape.csv"), Bytes("subpix/shape/shape.csv"));
}

}  // namespace
}  // namespace velamap
