// Our models through the eyes of the installed COLMAP.

#include <cstdlib>
#include <filesystem>
#include <regex>

#include <gmock/gmock.h>

#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

class ModelInColmap : public testing::TestWithParam<ModelFormat> {
 protected:
  void SetUp() override {
    if (std::system("command -v colmap > /dev/null 2>&1") != 0) {
      GTEST_SKIP() << "colmap is not on the PATH";
    }
    AddImageNoise(0.5, 3, &model_);
    RemoveObservation(&model_, 11, model_.points3D.at(11).track[0]);
    UpdatePointErrors(&model_);
    WriteModel(model_, dir_ / "in", GetParam());
    fs::create_directory(dir_ / "out");
  }

  std::string Run(const std::vector<std::string>& arguments) {
    return RunColmap("colmap", arguments, dir_ / "colmap.log");
  }

  double AnalyzedValue(const std::string& output, const std::string& key) {
    std::smatch match;
    EXPECT_TRUE(std::regex_search(output, match, std::regex(key + ": ([-+.e0-9]+)"))) << output;
    return match.empty() ? -1 : std::stod(match[1]);
  }

  TempDir dir_;
  Model model_ = MakeSheetModel();
};

TEST_P(ModelInColmap, ModelAnalyzerCountsWhatWeCount) {
  const std::string output = Run({"model_analyzer", "--path", dir_ / "in"});
  EXPECT_EQ(AnalyzedValue(output, "Cameras"), 1);
  EXPECT_EQ(AnalyzedValue(output, "Registered images"), 9);
  EXPECT_EQ(AnalyzedValue(output, "Points"), 80);
  EXPECT_EQ(AnalyzedValue(output, "Observations"), 719);
  double mean_error_px = 0.0;
  for (const auto& [point3D_id, point] : model_.points3D) mean_error_px += point.mean_error_px / 80;
  EXPECT_NEAR(AnalyzedValue(output, "Mean reprojection error"), mean_error_px, 1e-5);
}

// COLMAP normalizes quaternions and orders images as its hash table does: equal up to these.
TEST_P(ModelInColmap, ModelConverterGivesTheModelBack) {
  for (const char* type : {"TXT", "BIN"}) {
    fs::remove_all(dir_ / "out");
    fs::create_directory(dir_ / "out");
    Run({"model_converter", "--input_path", dir_ / "in", "--output_path", dir_ / "out",
         "--output_type", type});
    Model converted = ReadModel(dir_ / "out");
    ASSERT_EQ(converted.images.size(), model_.images.size());
    Model ordered = model_;
    ordered.images.clear();
    for (ModelImage& image : converted.images) {
      const ModelImage& ours = *model_.FindImage(image.image_id);
      EXPECT_LT(AngularDistance(image.cam_from_world, ours.cam_from_world), 1e-15);
      image.cam_from_world.rotation = ours.cam_from_world.rotation;
      ordered.images.push_back(ours);
    }
    EXPECT_EQ(Bytes(converted), Bytes(ordered)) << type;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ModelInColmap,
                         testing::Values(ModelFormat::kBinary, ModelFormat::kText));

}  // namespace
}  // namespace velamap
