// Cameras from rendered pictures of boards.

#include "workflows/calibrate/board_calibration.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "tests/support/chessboard_renderer.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

constexpr double kSquare_m = 0.03;
const Chessboard kBoard{7, 6};
const Camera kTruth{CameraModel::kRadial, 640, 480, {560, 326, 236, -0.12, 0.05}};

void RenderPictures(int num_pictures, std::uint32_t seed, const std::filesystem::path& folder) {
  ChessboardRenderOptions options;
  options.square_m = kSquare_m;
  options.noise_sigma = 2.0;
  options.supersampling = 3;
  int number = 0;
  for (const Rigid3& pose : DrawBoardPoses(kTruth, kBoard, kSquare_m, num_pictures, seed)) {
    options.seed = 1000 * seed + static_cast<std::uint32_t>(number);
    cv::imwrite((folder / ("picture_" + std::to_string(100 + number++) + ".png")).string(),
                RenderChessboard(kTruth, pose, kBoard, options));
  }
}

BoardCalibrationOptions OptionsFor(const std::filesystem::path& folder) {
  BoardCalibrationOptions options;
  options.image_path = folder.string();
  options.chessboard = kBoard;
  options.square_m = kSquare_m;
  return options;
}

TEST(BoardCalibration, AChessboardGivesTheCameraWithinItsSigmas) {
  std::vector<double> errors;
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const TempDir dir;
    RenderPictures(14, seed, dir.path());
    const BoardCalibration found = CalibrateWithBoard(OptionsFor(dir.path()));
    const CameraCalibration& calibration = found.calibration;
    EXPECT_EQ(found.board, "chessboard of 7 x 6 inner corners");
    EXPECT_TRUE(calibration.board.is_flat);
    EXPECT_LT(calibration.error_px.rms, 0.2);
    const Camera& camera = calibration.camera.camera;
    EXPECT_NEAR(MeanFocalLength(camera), 560, 5);
    const std::size_t num_focal = HasOneFocalLength(camera.model) ? 1 : 2;
    for (std::size_t i = 0; i < num_focal + 2; ++i) {
      const double truth = kTruth.params[i < num_focal ? 0 : i - num_focal + 1];
      errors.push_back((camera.params[i] - truth) / calibration.camera.sigmas[i]);
    }
  }
  EXPECT_LT(Rms(errors), 2.0);
  EXPECT_GT(Rms(errors), 0.3);
}

TEST(BoardCalibration, APictureWithoutTheChessboardSaysWhatToCount) {
  const TempDir dir;
  cv::imwrite((dir.path() / "a.png").string(), cv::Mat(240, 320, CV_8U, 128));
  ExpectThrows<DataError>([&] { CalibrateWithBoard(OptionsFor(dir.path())); },
                          {"chessboard of 7 x 6 inner corners", "where four squares meet"});
}

}  // namespace
}  // namespace velamap
