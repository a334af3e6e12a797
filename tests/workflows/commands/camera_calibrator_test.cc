// The command camera_calibrator on photographs of a real board.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "importer/camera/calibration.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

struct FocalLength {
  double value_px = 0.0, sigma_px = 0.0;
};

FocalLength Read(const fs::path& path) {
  cv::FileStorage file(path.string(), cv::FileStorage::READ);
  return {MeanFocalLength(ReadCalibration(path.string())),
          static_cast<double>(file["focal_length_sigma_px"][0])};
}

TEST(CameraCalibrator, TwoHalvesOfARealRecordingAgreeWithinTheirSigmas) {
  const TempDir dir;
  std::vector<fs::path> photographs;
  for (const auto& entry :
       fs::directory_iterator(std::string(VELAMAP_SOURCE_DIR) + "/tests/data/aprilgrid/images")) {
    photographs.push_back(entry.path());
  }
  std::sort(photographs.begin(), photographs.end());
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const fs::path half = dir.path() / std::to_string(i % 2);
    fs::create_directories(half);
    fs::copy(photographs[i], half / photographs[i].filename());
  }
  std::vector<FocalLength> halves;
  for (const std::string half : {"0", "1"}) {
    const fs::path camera = dir.path() / (half + ".yml");
    const ProgramRun run = RunVelamap({"camera_calibrator", "--image_path",
                                       (dir.path() / half).string(), "--output_path", camera});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("verdict: "), HasSubstr("unseen_error_px: "),
                               HasSubstr("camera_path: ")));
    EXPECT_THAT(
        ReadFileBytes(dir.path() / (half + ".html")),
        AllOf(HasSubstr("<title>" + half + ".yml from " + half + " "), HasSubstr("</html>")));
    halves.push_back(Read(camera));
  }
  const double sigma_px = std::hypot(halves[0].sigma_px, halves[1].sigma_px);
  EXPECT_LT(std::abs(halves[0].value_px - halves[1].value_px), 3 * sigma_px);
  EXPECT_LT(sigma_px, 0.1 * halves[0].value_px);
}

}  // namespace
}  // namespace velamap
