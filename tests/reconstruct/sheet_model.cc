#include "tests/reconstruct/sheet_model.h"

#include <algorithm>
#include <random>
#include <sstream>

#include "importer/geometry/alignment.h"
#include "importer/geometry/units.h"
#include "reconstruct/model/model_io.h"

namespace velamap {
namespace {

constexpr double kDistance = 4.0;

Camera MakeCamera(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return {model, 1920, 1080, {1200, 1210, 955.5, 542.25}};
    case CameraModel::kSimpleRadial:
      return {model, 1920, 1080, {1200, 955.5, 542.25, -0.02}};
    default:
      return {CameraModel::kOpenCV,
              1920,
              1080,
              {1200, 1210, 955.5, 542.25, -0.05, 0.01, 0.001, -0.0005}};
  }
}

// Point of the sheet at (u, v) in [-1, 1]^2.
Eigen::Vector3d SheetPoint(double u, double v) {
  return {1.5 * u, v, 0.4 * (1 - u * u) * (1 + 0.3 * v)};
}

// Looks at the sheet's middle from an angle along the arc.
Rigid3 CamFromWorld(double angle_rad, double height) {
  const Eigen::Vector3d centre(kDistance * std::sin(angle_rad), height,
                               kDistance * std::cos(angle_rad));
  const Eigen::Vector3d z = -centre.normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(0, -1, 0).cross(z).normalized();
  Eigen::Matrix3d cam_from_world;
  cam_from_world << x.transpose(), z.cross(x).transpose(), z.transpose();
  const Eigen::Quaterniond rotation(cam_from_world);
  return {rotation, -(rotation * centre)};
}

Eigen::Vector3d RandomVector(double sigma, std::mt19937* random) {
  std::normal_distribution<double> normal(0.0, sigma);
  const double x = normal(*random), y = normal(*random);
  return {x, y, normal(*random)};
}

}  // namespace

Model MakeSheetModel(const SheetOptions& options) {
  Model model;
  model.cameras[1] = MakeCamera(options.camera_model);
  for (int i = 0; i < options.num_images; ++i) {
    // 4 is prime to the usual numbers of images, so that neighbours in the list are far apart.
    const int place = options.time_order ? i : 4 * i % options.num_images;
    const double s = 2.0 * place / (options.num_images - 1) - 1.0;
    ModelImage image;
    image.image_id = static_cast<ImageId>(i + 1);
    image.camera_id = 1;
    image.name = "frame_" + std::to_string(i) + ".jpg";
    image.cam_from_world = CamFromWorld(0.6 * s, 0.4 * std::sin(3.0 * s));
    model.images.push_back(image);
  }
  const auto scale = [](int i, int count) { return (2.0 * i + 1.0) / count - 1.0; };
  for (int k = 0; k < options.num_rows * options.num_columns; ++k) {
    const double u = scale(k % options.num_columns, options.num_columns);
    const double v = scale(k / options.num_columns, options.num_rows);
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const double du = corner == 1 || corner == 4 ? -0.05 : 0.05;
      const double dv = corner <= 2 ? 0.08 : -0.08;
      Point3D point;
      point.x_in_world = SheetPoint(u + du, v + dv);
      point.color = {static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(corner), 255};
      const Point3DId id = Point3DIdFromCorner({k + 1, corner});
      for (ModelImage& image : model.images) {
        const auto x_in_image_px =
            ImageFromCam(model.cameras.at(1), image.cam_from_world * point.x_in_world);
        point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
        image.points2D.push_back({x_in_image_px.value(), id});
      }
      model.points3D.emplace(id, std::move(point));
    }
  }
  return model;
}

void AddImageNoise(double sigma_px, std::uint32_t seed, Model* model) {
  std::mt19937 random(seed);
  for (ModelImage& image : model->images) {
    for (Point2D& point2D : image.points2D) {
      point2D.x_in_image_px += RandomVector(sigma_px, &random).head<2>();
    }
  }
}

void PerturbSeed(double fraction, std::uint32_t seed, Model* model) {
  std::mt19937 random(seed);
  for (ModelImage& image : model->images) {
    const Eigen::Vector3d turn = RandomVector(fraction, &random);
    Rigid3& pose = image.cam_from_world;
    pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.rotation;
    pose.translation += RandomVector(fraction * kDistance, &random);
  }
  for (auto& [point3D_id, point] : model->points3D) {
    point.x_in_world += RandomVector(fraction * kDistance, &random);
  }
}

std::vector<std::pair<Point3DId, TrackElement>> AddOutliers(double fraction, std::uint32_t seed,
                                                            Model* model) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::pair<Point3DId, TrackElement>> outliers;
  for (const auto& [point3D_id, point] : model->points3D) {
    for (const TrackElement& element : point.track) {
      if (uniform(random) >= fraction) continue;
      const double angle = 2 * kPi * uniform(random);
      const double shift_px = 50 + 250 * uniform(random);
      const auto image = std::find_if(
          model->images.begin(), model->images.end(),
          [&element](const ModelImage& other) { return other.image_id == element.image_id; });
      image->points2D[element.point2D_idx].x_in_image_px +=
          shift_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      outliers.emplace_back(point3D_id, element);
    }
  }
  return outliers;
}

std::vector<double> PointErrors(const Model& model, const Model& truth) {
  std::vector<Eigen::Vector3d> x_in_model, x_in_truth;
  for (const auto& [point3D_id, point] : model.points3D) {
    x_in_model.push_back(point.x_in_world);
    x_in_truth.push_back(truth.points3D.at(point3D_id).x_in_world);
  }
  const Sim3 truth_from_model = EstimateSim3(x_in_model, x_in_truth);
  std::vector<double> errors;
  for (std::size_t i = 0; i < x_in_model.size(); ++i) {
    errors.push_back((truth_from_model * x_in_model[i] - x_in_truth[i]).norm());
  }
  return errors;
}

double MaxPointError(const Model& model, const Model& truth) {
  const std::vector<double> errors = PointErrors(model, truth);
  return *std::max_element(errors.begin(), errors.end());
}

std::string Bytes(const Model& model) {
  std::ostringstream out;
  WriteCamerasBinary(model, out);
  WriteImagesBinary(model, out);
  WritePoints3DBinary(model, out);
  return out.str();
}

}  // namespace velamap
