// The half pixel between OpenCV's image frame (first pixel's centre at (0,0)) and COLMAP's (at
// (0.5,0.5)), proven by what COLMAP itself finds and undistorts in pictures drawn with OpenCV.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/camera/calibration.h"
#include "reconstruct/model/model_io.h"
#include "tests/workflows/interop/colmap_tools.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
namespace fs = std::filesystem;

constexpr int kWidth = 1280, kHeight = 960;
const Eigen::Vector2d kHalfPixel(0.5, 0.5);

struct PlacedSquare {
  int marker_id;
  int x, y;  // first black pixel
  int side;  // px
};

const std::vector<PlacedSquare> kMarkers = {
    {3, 100, 80, 120}, {17, 640, 90, 156}, {42, 1010, 700, 90}};

// Centres in OpenCV's pixels.
std::vector<Eigen::Vector2d> BlobCenters() {
  return {{380.0, 200.0},   {500.25, 430.5}, {180.7, 520.3},   {820.4, 560.85},
          {330.55, 800.15}, {700.9, 780.6},  {1120.35, 420.7}, {905.1, 345.95}};
}

constexpr double kBlobSigmaPx = 5.0;

// Dark blobs on light ground, each pixel the Gaussian's value at its centre.
void DrawBlobs(cv::Mat* picture) {
  for (const Eigen::Vector2d& center : BlobCenters()) {
    const int reach = static_cast<int>(6 * kBlobSigmaPx);
    const int x0 = static_cast<int>(center.x()), y0 = static_cast<int>(center.y());
    for (int y = y0 - reach; y <= y0 + reach; ++y) {
      for (int x = x0 - reach; x <= x0 + reach; ++x) {
        const double distance2 = (Eigen::Vector2d(x, y) - center).squaredNorm();
        picture->at<float>(y, x) -=
            static_cast<float>(150 * std::exp(-0.5 * distance2 / (kBlobSigmaPx * kBlobSigmaPx)));
      }
    }
  }
}

cv::Mat DrawPicture() {
  cv::Mat picture(kHeight, kWidth, CV_32F, cv::Scalar(210));
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  for (const PlacedSquare& marker : kMarkers) {
    cv::Mat bits;
    cv::aruco::drawMarker(dictionary, marker.marker_id, marker.side, bits, 1);
    bits.convertTo(picture(cv::Rect(marker.x, marker.y, marker.side, marker.side)), CV_32F,
                   170.0 / 255, 40);
  }
  cv::GaussianBlur(picture, picture, {}, 1.0);
  DrawBlobs(&picture);
  picture.convertTo(picture, CV_8U);
  return picture;
}

// A square's edges lie half a pixel outside the centres of its outer pixels.
std::vector<Eigen::Vector2d> CornersInOpenCv(const PlacedSquare& marker) {
  const double left = marker.x - 0.5, top = marker.y - 0.5;
  const double right = left + marker.side, bottom = top + marker.side;
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

Eigen::Vector2d NearestTo(const Eigen::Vector2d& x, const std::vector<Eigen::Vector2d>& points) {
  return *std::min_element(points.begin(), points.end(), [&x](const auto& a, const auto& b) {
    return (a - x).norm() < (b - x).norm();
  });
}

// Centre of mass of what is darker than the ground, in OpenCV's pixels.
Eigen::Vector2d BlobCentroid(const cv::Mat& gray, const Eigen::Vector2d& near_in_opencv_px) {
  const int reach = static_cast<int>(4 * kBlobSigmaPx);
  const int x0 = static_cast<int>(std::lround(near_in_opencv_px.x()));
  const int y0 = static_cast<int>(std::lround(near_in_opencv_px.y()));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight_sum = 0.0;
  for (int y = y0 - reach; y <= y0 + reach; ++y) {
    for (int x = x0 - reach; x <= x0 + reach; ++x) {
      const double weight = std::max(0.0, 207.0 - gray.at<std::uint8_t>(y, x));
      sum += weight * Eigen::Vector2d(x, y);
      weight_sum += weight;
    }
  }
  return sum / weight_sum;
}

class ColmapPicturesTest : public ColmapTest {
 protected:
  void SetUp() override {
    ColmapTest::SetUp();
    if (IsSkipped()) return;
    fs::create_directory(dir_ / "images");
    cv::imwrite(path("images/picture.png"), DrawPicture());
    cv::FileStorage file(path("camera.yml"), cv::FileStorage::WRITE);
    file << "image_width" << kWidth << "image_height" << kHeight << "camera_matrix"
         << cv::Mat(camera_matrix_) << "distortion_coefficients" << cv::Mat(distortion_);
  }

  void Import(const std::vector<std::string>& calibration) {
    std::vector<std::string> arguments = {
        "marker_importer", "--image_path", path("images"),    "--dictionary", "DICT_4X4_50",
        "--marker_length", "0.1",          "--database_path", path("ours.db")};
    arguments.insert(arguments.end(), calibration.begin(), calibration.end());
    const ProgramRun run = RunVelamap(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  // A model of the one picture, its keypoints at the blobs.
  Model OneImageModel() const {
    Model model;
    model.cameras[1] = ReadCalibration(path("camera.yml"));
    ModelImage image;
    image.image_id = 1;
    image.camera_id = 1;
    image.name = "picture.png";
    for (const Eigen::Vector2d& center : BlobCenters()) {
      image.points2D.push_back({center + kHalfPixel, kInvalidPoint3DId});
    }
    model.images.push_back(image);
    return model;
  }

  // Ray of an OpenCV pixel by OpenCV's own model.
  Eigen::Vector2d OpenCvRay(const Eigen::Vector2d& x_in_opencv_px) const {
    std::vector<cv::Point2d> points = {{x_in_opencv_px.x(), x_in_opencv_px.y()}}, rays;
    cv::undistortPoints(points, rays, camera_matrix_, distortion_, cv::noArray(), cv::noArray(),
                        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12});
    return {rays[0].x, rays[0].y};
  }

  const cv::Matx33d camera_matrix_{1100, 0, 633.2, 0, 1103, 471.7, 0, 0, 1};
  const cv::Matx41d distortion_{-0.25, 0.07, 0.002, -0.0015};
};

TEST_F(ColmapPicturesTest, KeypointsOfColmapLieHalfAPixelBeyondOpenCvs) {
  std::vector<std::string> arguments = {"feature_extractor", "--database_path", path("sift.db"),
                                        "--image_path", path("images")};
  AddOption({"SiftExtraction.use_gpu", "FeatureExtraction.use_gpu"}, "0", &arguments);
  RunCommand(arguments);
  const auto keypoints = QueryKeypoints(path("sift.db"), "picture.png");
  Eigen::Vector2d mean_shift = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& center : BlobCenters()) {
    const Eigen::Vector2d keypoint = NearestTo(center, keypoints);
    EXPECT_LT((keypoint - center - kHalfPixel).norm(), 0.1) << center.transpose();
    mean_shift += (keypoint - center) / static_cast<double>(BlobCenters().size());
  }
  EXPECT_LT((mean_shift - kHalfPixel).norm(), 0.05) << mean_shift.transpose();
  RecordProperty("mean_shift_px", testing::PrintToString(mean_shift.transpose()));
}

// The markers are drawn with straight sides, which the lens of camera.yml would bend.
TEST_F(ColmapPicturesTest, MarkerCornersLieHalfAPixelBeyondOpenCvs) {
  Import({});
  const auto keypoints = QueryKeypoints(path("ours.db"), "picture.png");
  ASSERT_EQ(keypoints.size(), 4 * kMarkers.size());
  double max_error_px = 0.0;
  for (std::size_t i = 0; i < kMarkers.size(); ++i) {
    const auto corners = CornersInOpenCv(kMarkers[i]);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const double error_px = (keypoints[4 * i + corner] - corners[corner] - kHalfPixel).norm();
      EXPECT_LT(error_px, 0.1) << "marker " << kMarkers[i].marker_id << ", corner " << corner + 1;
      max_error_px = std::max(max_error_px, error_px);
    }
  }
  RecordProperty("max_error_px", std::to_string(max_error_px));
}

TEST_F(ColmapPicturesTest, PrincipalPointArrivesHalfAPixelBeyondOpenCvs) {
  Import({"--camera_path", path("camera.yml")});
  const auto near = [](double value) { return DoubleNear(value, 1e-9); };
  EXPECT_THAT(QueryCameraParams(path("ours.db")),
              ElementsAre(near(1100), near(1103), near(633.7), near(472.2), near(-0.25), near(0.07),
                          near(0.002), near(-0.0015)));
}

TEST_F(ColmapPicturesTest, UndistorterAgreesWithOurCameraAndWithOpenCv) {
  WriteModel(OneImageModel(), path("model"), ModelFormat::kBinary);
  RunCommand({"image_undistorter", "--image_path", path("images"), "--input_path", path("model"),
              "--output_path", path("undistorted"), "--output_type", "COLMAP"});
  const Model undistorted = ReadModel(path("undistorted/sparse"));
  ASSERT_EQ(undistorted.cameras.size(), 1u);
  const Camera& pinhole = undistorted.cameras.begin()->second;
  ASSERT_EQ(pinhole.model, CameraModel::kPinhole);
  const cv::Mat picture = cv::imread(path("undistorted/images/picture.png"), cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(picture.cols, pinhole.width_px);
  ASSERT_EQ(picture.rows, pinhole.height_px);

  const Model model = OneImageModel();
  double max_keypoint_error_px = 0.0, max_picture_error_px = 0.0, max_shift_px = 0.0;
  for (std::size_t i = 0; i < BlobCenters().size(); ++i) {
    const Eigen::Vector2d center = BlobCenters()[i];
    const Eigen::Vector2d ray = *CamFromImage(model.cameras.at(1), center + kHalfPixel);
    EXPECT_LT((ray - OpenCvRay(center)).norm(), 1e-9);
    const Eigen::Vector2d predicted_px = *ImageFromCam(pinhole, ray.homogeneous());
    max_shift_px = std::max(max_shift_px, (predicted_px - center - kHalfPixel).norm());
    const Eigen::Vector2d keypoint_px = undistorted.images.at(0).points2D.at(i).x_in_image_px;
    max_keypoint_error_px = std::max(max_keypoint_error_px, (keypoint_px - predicted_px).norm());
    const Eigen::Vector2d found_px = BlobCentroid(picture, predicted_px - kHalfPixel) + kHalfPixel;
    max_picture_error_px = std::max(max_picture_error_px, (found_px - predicted_px).norm());
  }
  EXPECT_GT(max_shift_px, 10);  // the distortion is worth undoing
  EXPECT_LT(max_keypoint_error_px, 1e-6);
  EXPECT_LT(max_picture_error_px, 0.1);
  RecordProperty("max_keypoint_error_px", testing::PrintToString(max_keypoint_error_px));
  RecordProperty("max_picture_error_px", testing::PrintToString(max_picture_error_px));
}

}  // namespace
}  // namespace velamap
