#include "reconstruct/camera_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_projection.h"
#include "importer/camera/turned_camera.h"
#include "importer/geometry/units.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

constexpr double kNoisePx = 0.08;
constexpr double kLength_m = 0.04, kSpacing_m = 0.07;
constexpr int kNumColumns = 4, kNumRows = 3;

const Camera kTruth{
    CameraModel::kOpenCV, 1280, 720, {950, 950, 646, 355, -0.11, 0.03, 0.0006, -0.0004}};

// Flaws of the print: how far it is bent, and by what fraction it is too wide.
struct Flaws {
  double bend_m = 0.0, stretch = 0.0;
};

using BoardCorners = std::map<int, std::array<Eigen::Vector3d, kNumCorners>>;

BoardCorners MakeBoard(const Flaws& flaws) {
  const double half_m = 0.5 * kNumColumns * kSpacing_m;
  BoardCorners board;
  for (int i = 0; i < kNumColumns * kNumRows; ++i) {
    const double x_m = (i % kNumColumns - 0.5 * (kNumColumns - 1)) * kSpacing_m;
    const double y_m = (0.5 * (kNumRows - 1) - i / kNumColumns) * kSpacing_m;
    const double h = 0.5 * kLength_m;
    const std::array<Eigen::Vector2d, kNumCorners> corners = {
        Eigen::Vector2d(-h, h), {h, h}, {h, -h}, {-h, -h}};
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      const double x = (x_m + corners[c].x()) * (1.0 + flaws.stretch);
      board[i][c] = {x, y_m + corners[c].y(), flaws.bend_m * std::pow(x / half_m, 2)};
    }
  }
  return board;
}

// The largest distance from the plane of the corners, m.
double BendOf(const BoardCorners& board) {
  std::vector<double> z_m;
  for (const auto& [marker_id, corners] : board) {
    for (const Eigen::Vector3d& x : corners) z_m.push_back(x.z());
  }
  const Statistics statistics = ComputeStatistics(z_m);
  return std::max(statistics.max - statistics.mean, statistics.mean - statistics.min);
}

// Mean over the squares of how much wider they are than high. The bend adds to it.
double StretchOf(const BoardCorners& board) {
  double sum = 0.0;
  for (const auto& [marker_id, x] : board) {
    sum += std::log((x[1] - x[0]).norm() / (x[3] - x[0]).norm());
  }
  return sum / static_cast<double>(board.size());
}

// The board in all parts of the picture, tilted to all sides, as far away as fills half of it.
std::vector<DatabaseImage> TakePictures(const BoardCorners& board, const Camera& camera,
                                        std::uint32_t seed, int num_images = 16) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<DatabaseImage> images;
  for (int i = 0; i < num_images; ++i) {
    const double distance_m = 0.45 + 0.12 * uniform(generator);
    const auto ray = CamFromImage(camera, {(0.5 + 0.4 * uniform(generator)) * camera.width_px,
                                           (0.5 + 0.4 * uniform(generator)) * camera.height_px});
    const Eigen::Vector3d axis =
        Eigen::Vector3d(uniform(generator), uniform(generator), 0.0).normalized();
    // The face of a board looks along its z, towards the camera.
    const Eigen::Quaterniond rotation =
        Eigen::AngleAxisd(0.6 * std::abs(uniform(generator)), axis) *
        Eigen::AngleAxisd(kPi * uniform(generator), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
    const Rigid3 cam_from_board{rotation, distance_m * ray->homogeneous()};
    DatabaseImage image{static_cast<ImageId>(i + 1), 1, {}};
    image.detections.image_name = "image_" + std::to_string(100 + i) + ".png";
    for (const auto& [marker_id, corners] : board) {
      MarkerDetection marker;
      marker.marker_id = marker_id;
      bool is_inside = true;
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const auto x_px = ImageFromCam(camera, cam_from_board * corners[c]);
        is_inside = is_inside && x_px && (x_px->array() > 0).all() && x_px->x() < camera.width_px &&
                    x_px->y() < camera.height_px;
        if (!is_inside) break;
        const Eigen::Vector2d noise(normal(generator), normal(generator));
        marker.corners_in_image_px[c] = *x_px + kNoisePx * noise;
        marker.corner_sigma_px[c] = kNoisePx;
      }
      if (is_inside) image.detections.markers.push_back(marker);
    }
    images.push_back(image);
  }
  return images;
}

CameraCalibration Calibrate(const std::vector<DatabaseImage>& images,
                            const CameraCalibrationOptions& options = {},
                            double length_m = kLength_m) {
  return CalibrateCamera(options, images, {{1, UnknownCamera(kTruth.width_px, kTruth.height_px)}},
                         MakeLayout("DICT_4X4_50", length_m), std::nullopt);
}

// Focal lengths and principal point, in sigmas.
std::vector<double> ErrorsInSigmas(const EstimatedCamera& found, const Camera& truth) {
  const std::size_t num_focal = NumFocalLengths(found.camera.model);
  std::vector<double> errors;
  for (std::size_t i = 0; i < num_focal + 2; ++i) {
    const double expected = truth.params[i < num_focal ? i : 2 + i - num_focal];
    errors.push_back((found.camera.params[i] - expected) / found.sigmas[i]);
  }
  return errors;
}

TEST(CameraCalibration, ParametersLieWithinTheirSigmas) {
  const BoardCorners board = MakeBoard({0.004, 0.003});
  std::vector<double> errors;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const CameraCalibration found = Calibrate(TakePictures(board, kTruth, seed));
    for (const double error : ErrorsInSigmas(found.camera, kTruth)) errors.push_back(error);
    if (found.camera.camera.model != kTruth.model) continue;
    for (std::size_t i = 4; i < kTruth.params.size(); ++i) {
      errors.push_back((found.camera.camera.params[i] - kTruth.params[i]) / found.camera.sigmas[i]);
    }
  }
  EXPECT_GT(Rms(errors), 0.7);
  EXPECT_LT(Rms(errors), 1.4);
}

TEST(CameraCalibration, TheBoardsFlawsAreEstimated) {
  const CameraCalibration found = Calibrate(TakePictures(MakeBoard({0.004, 0.003}), kTruth, 1));
  EXPECT_TRUE(found.board.is_flat);
  EXPECT_NEAR(found.board.stretch, StretchOf(MakeBoard({0.004, 0.003})),
              4 * found.board.stretch_sigma);
  EXPECT_LT(found.board.stretch_sigma, 0.001);
  const CameraCalibration flat = Calibrate(TakePictures(MakeBoard({}), kTruth, 1));
  EXPECT_LT(flat.board.bend_m, 3 * flat.board.bend_sigma_m);
  EXPECT_GT(found.board.bend_m, 5 * flat.board.bend_m);
  EXPECT_NEAR(found.board.max_bend_m, BendOf(MakeBoard({0.004, 0.003})),
              5 * found.board.bend_sigma_m);
}

TEST(CameraCalibration, TheSizeOfThePrintDoesNotMatter) {
  const std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 2);
  const EstimatedCamera right = Calibrate(images).camera;
  const EstimatedCamera small = Calibrate(images, {}, 0.997 * kLength_m).camera;
  ASSERT_EQ(small.camera.model, right.camera.model);
  for (std::size_t i = 0; i < right.sigmas.size(); ++i) {
    EXPECT_NEAR(small.camera.params[i], right.camera.params[i], 0.02 * right.sigmas[i]) << i;
  }
}

TEST(CameraCalibration, AFisheyeIsNoPinhole) {
  const Camera fisheye{
      CameraModel::kOpenCVFisheye, 1280, 720, {520, 520, 644, 357, 0.03, -0.01, 0.002, 0}};
  const std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), fisheye, 3, 16);
  const CameraCalibration found = Calibrate(images);
  EXPECT_EQ(found.camera.camera.model, CameraModel::kOpenCVFisheye);
  for (const double error : ErrorsInSigmas(found.camera, fisheye)) EXPECT_LT(std::abs(error), 4.0);
  CameraCalibrationOptions pinhole;
  pinhole.camera_model = CameraModel::kSimplePinhole;
  ExpectThrows<DataError>([&] { Calibrate(images, pinhole); }, {"OPENCV_FISHEYE leaves"});
  pinhole.camera_model = CameraModel::kRadial;
  const CameraCalibration forced = Calibrate(images, pinhole);
  EXPECT_EQ(forced.camera.camera.model, CameraModel::kRadial);
  EXPECT_GT(forced.Score().unseen_error_px, 2 * found.Score().unseen_error_px);
  const PictureGrid grid = MakePictureGrid(1280, 720, kNumCoverageCells);
  const auto pattern_px = [&](const CameraCalibration& calibration) {
    return SystematicResidual(ResidualsInCells(calibration.residuals, grid));
  };
  EXPECT_GT(pattern_px(forced), 3 * pattern_px(found));
}

TEST(CameraCalibration, PicturesThatAreAlikeAreRefused) {
  std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 4, 1);
  for (ImageId id = 2; id <= 10; ++id) {
    images.push_back(images.front());
    images.back().image_id = id;
    images.back().detections.image_name += std::to_string(id);
  }
  ExpectThrows<DataError>([&] { Calibrate(images); }, {"all 10 pictures are alike"});
  images.resize(1);
  ExpectThrows<DataError>([&] { Calibrate(images); }, {"no marker is in two of the pictures"});
}

void ZoomPicture(double zoom, DatabaseImage* image) {
  const Eigen::Vector2d center(646, 355);
  for (MarkerDetection& marker : image->detections.markers) {
    for (Eigen::Vector2d& x_px : marker.corners_in_image_px) {
      x_px = center + zoom * (x_px - center);
    }
  }
}

TEST(CameraCalibration, AZoomInTheMiddleIsRefused) {
  for (const double zoom : {1.05, 1.5}) {
    std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 5, 20);
    for (std::size_t i = 10; i < images.size(); ++i) ZoomPicture(zoom, &images[i]);
    ExpectThrows<DataError>([&] { Calibrate(images); }, {"the lens was zoomed"});
  }
}

// With a zoom of 1.5, the pictures of one setting fit no pose among those of the other.
TEST(CameraCalibration, TwoZoomsThatAlternateAreRefused) {
  for (const double zoom : {1.1, 1.5}) {
    std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 5, 20);
    for (std::size_t i = 1; i < images.size(); i += 2) ZoomPicture(zoom, &images[i]);
    ExpectThrows<DataError>([&] { Calibrate(images); },
                            {"of the pictures, image_101.png the first of them, have a focal"});
  }
}

// The first picture of a clip 20 times, as where a video stands still: with the noise of one
// picture, and not of 20.
TEST(CameraCalibration, RepeatedFramesCountOnce) {
  const std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 6, 20);
  const auto frozen = [&](double zoom) {
    std::vector<DatabaseImage> clip(20, images.front());
    clip.insert(clip.end(), images.begin(), images.end());
    for (std::size_t i = 0; i < clip.size(); ++i) {
      clip[i].image_id = static_cast<ImageId>(i + 1);
      clip[i].detections.image_name = "frame_" + std::to_string(100 + i) + ".png";
      if (i >= 30) ZoomPicture(zoom, &clip[i]);
    }
    return clip;
  };
  const CameraCalibration found = Calibrate(frozen(1.0));
  EXPECT_EQ(found.UsedViews().size(), 20u);
  EXPECT_NEAR(found.camera.camera.params[0], kTruth.params[0], 4 * found.camera.sigmas[0]);
  EXPECT_LT(found.camera.sigmas[0], 0.005 * kTruth.params[0]);
  ExpectThrows<DataError>([&] { Calibrate(frozen(1.05)); }, {"about frame_130.png"});
}

// Half of the pictures are taken with the camera turned; they show the same places of the lens.
TEST(CameraCalibration, TurnedPicturesAreChosenAsUprightOnes) {
  const std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 8, 24);
  std::vector<DatabaseImage> turned = images;
  for (std::size_t i = 1; i < turned.size(); i += 2) {
    turned[i].camera_id = 2;
    for (MarkerDetection& marker : turned[i].detections.markers) {
      for (Eigen::Vector2d& x_px : marker.corners_in_image_px) x_px = TurnInImage(kTruth, 1, x_px);
    }
  }
  CameraCalibrationOptions options;
  options.max_num_views = 12;
  const CameraCalibration found = CalibrateCamera(
      options, turned, {{1, UnknownCamera(1280, 720)}, {2, UnknownCamera(720, 1280)}},
      MakeLayout("DICT_4X4_50", kLength_m), std::nullopt);
  const CameraCalibration expected = Calibrate(images, options);
  ASSERT_EQ(found.views.size(), expected.views.size());
  for (std::size_t i = 0; i < found.views.size(); ++i) {
    EXPECT_EQ(found.views[i].view.image_id, expected.views[i].view.image_id);
    EXPECT_EQ(found.views[i].view.Tilt(), expected.views[i].view.Tilt());
  }
}

TEST(CameraCalibration, TwoCamerasAreRefused) {
  std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 6);
  images.back().camera_id = 2;
  ExpectThrows<DataError>(
      [&] {
        CalibrateCamera({}, images, {{1, UnknownCamera(1280, 720)}, {2, UnknownCamera(640, 360)}},
                        MakeLayout("DICT_4X4_50", kLength_m), std::nullopt);
      },
      {"1280 x 720 and 640 x 360 px"});
}

TEST(BoardViews, SharpAndNewViewsComeFirst) {
  std::vector<DatabaseImage> images = TakePictures(MakeBoard({}), kTruth, 7, 12);
  const PictureGrid grid = MakePictureGrid(1280, 720, kNumCoverageCells);
  // The same pictures, blurred.
  for (std::size_t i = 0; i < 12; ++i) {
    images.push_back(images[i]);
    for (MarkerDetection& marker : images.back().detections.markers) {
      marker.corner_sigma_px.fill(5 * kNoisePx);
    }
  }
  const std::vector<BoardView> views = DescribeBoardViews(images, 0.1);
  ASSERT_EQ(views.size(), images.size());
  for (const std::size_t idx : ChooseBoardViews(views, grid, 8)) EXPECT_LT(idx, 12u);
  EXPECT_EQ(ChooseBoardViews(views, grid, 100).size(), views.size());
}

TEST(BoardViews, TiltIsThatOfTheBoard) {
  const Camera camera{CameraModel::kPinhole, 1280, 720, {2000, 2000, 640, 360}};
  for (const double tilt_deg : {0.0, 30.0, 50.0}) {
    DatabaseImage image{1, 1, {}};
    const Eigen::Quaterniond about_y(
        Eigen::AngleAxisd(kRadPerDeg * tilt_deg, Eigen::Vector3d::UnitY()));
    for (const auto& [marker_id, corners] : MakeBoard({})) {
      MarkerDetection marker;
      marker.marker_id = marker_id;
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d x(corners[c].x(), -corners[c].y(), 0.0);
        marker.corners_in_image_px[c] =
            *ImageFromCam(camera, about_y * x + Eigen::Vector3d(0, 0, 2));
      }
      image.detections.markers.push_back(marker);
    }
    const BoardView view = DescribeBoardViews({image}, 0.1).front();
    EXPECT_NEAR(view.tilt_deg, tilt_deg, 3.0);
    EXPECT_EQ(view.Tilt(), tilt_deg > 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace velamap
