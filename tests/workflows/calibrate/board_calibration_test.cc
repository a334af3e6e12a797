// Cameras from rendered pictures of boards.

#include "workflows/calibrate/board_calibration.h"

#include <array>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_projection.h"
#include "importer/layout/dictionary.h"
#include "importer/print/png_file.h"
#include "tests/support/error_matchers.h"
#include "tests/support/render/board_renderer.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

const Chessboard kBoard{7, 6};
const Camera kTruth{CameraModel::kRadial, 320, 240, {280, 163, 118, -0.12, 0.05}};

enum class Kind { kChessboard, kCharuco, kMarkerGrid };

PrintedBoard Print(Kind kind) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  switch (kind) {
    case Kind::kCharuco:
      return PrintCharuco(7, 5, dictionary, 0.024);
    case Kind::kMarkerGrid:
      return PrintMarkerGrid(5, 4, dictionary, 0.03);
    default:
      return PrintChessboard(kBoard, 0.03);
  }
}

void RenderPictures(Kind kind, std::uint32_t seed, const std::filesystem::path& folder) {
  constexpr int kNumPictures = 10;
  BoardRenderOptions options;
  options.noise_sigma = 2.0;
  const PrintedBoard board = Print(kind);
  int number = 0;
  for (const Rigid3& pose : DrawBoardPoses(kTruth, board, kNumPictures, seed)) {
    options.seed = 1000 * seed + static_cast<std::uint32_t>(number);
    std::ofstream(folder / ("picture_" + std::to_string(100 + number++) + ".png"))
        << EncodePng(RenderBoard(kTruth, pose, board, options));
  }
}

BoardCalibrationOptions OptionsFor(Kind kind, const std::filesystem::path& folder) {
  BoardCalibrationOptions options;
  options.image_path = folder.string();
  // It takes longer than all else, and has tests of its own.
  options.detection.estimate_formation = false;
  if (kind == Kind::kChessboard) options.chessboard = kBoard;
  return options;
}

class BoardCalibrationTest : public testing::TestWithParam<Kind> {};

TEST_P(BoardCalibrationTest, RenderedBoardsGiveTheCameraWithinItsSigmas) {
  std::vector<double> errors;
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const TempDir dir;
    RenderPictures(GetParam(), seed, dir.path());
    const CameraCalibration calibration =
        CalibrateWithBoard(OptionsFor(GetParam(), dir.path())).calibration;
    EXPECT_TRUE(calibration.board.is_flat) << seed;
    EXPECT_LT(calibration.error_px.rms, 0.2) << seed;
    const Camera& camera = calibration.camera.camera;
    EXPECT_NEAR(MeanFocalLength(camera), kTruth.params[0], 2.5) << seed;
    const std::size_t num_focal = HasOneFocalLength(camera.model) ? 1 : 2;
    for (std::size_t i = 0; i < num_focal + 2; ++i) {
      const double truth = kTruth.params[i < num_focal ? 0 : i - num_focal + 1];
      errors.push_back((camera.params[i] - truth) / calibration.camera.sigmas[i]);
    }
  }
  EXPECT_LT(Rms(errors), 2.0);
  EXPECT_GT(Rms(errors), 0.3);
}

std::string NameOf(const testing::TestParamInfo<Kind>& test) {
  constexpr std::array<const char*, 3> kNames = {"Chessboard", "Charuco", "MarkerGrid"};
  return kNames[static_cast<std::size_t>(test.param)];
}

INSTANTIATE_TEST_SUITE_P(Boards, BoardCalibrationTest,
                         testing::Values(Kind::kChessboard, Kind::kCharuco, Kind::kMarkerGrid),
                         NameOf);

TEST(BoardCalibration, APictureWithoutTheChessboardSaysWhatToCount) {
  const TempDir dir;
  std::ofstream(dir / "a.png") << EncodePng(cv::Mat(240, 320, CV_8U, 128));
  ExpectThrows<DataError>([&] { CalibrateWithBoard(OptionsFor(Kind::kChessboard, dir.path())); },
                          {"chessboard of 7 x 6 inner corners", "where four squares meet"});
}

}  // namespace
}  // namespace velamap
