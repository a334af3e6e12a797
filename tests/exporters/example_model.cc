#include "tests/exporters/example_model.h"

#include <random>
#include <sstream>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kLength_m = 0.1;
constexpr double kSmallLength_m = 0.05;

std::array<Eigen::Vector3d, kNumCorners> CornersInMarker(double length_m) {
  const double h = 0.5 * length_m;
  return {{{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}}};
}

// Markers on the outside of a cylinder with a radius of 2 m about the y axis, and a flat row below.
Rigid3 WorldFromMarker(int marker_id) {
  if (marker_id >= 100) return {Eigen::Quaterniond::Identity(), {0.3 * (marker_id - 120), -1, 2}};
  const int row = (marker_id - 1) / 3, column = (marker_id - 1) % 3;
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(0.15 * (column - 1), Eigen::Vector3d::UnitY()));
  return {rotation, rotation * Eigen::Vector3d(0, 0, 2) + Eigen::Vector3d(0, 0.4 * row, 0)};
}

// A camera at `x_in_world` that looks along -z of the world with y up.
Rigid3 CamFromWorld(const Eigen::Vector3d& x_in_world, double yaw_rad) {
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) *
      Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  return {rotation, -(rotation * x_in_world)};
}

void AddMarker(int marker_id, double length_m, Model* model) {
  const Rigid3 world_from_marker = WorldFromMarker(marker_id);
  const auto corners = CornersInMarker(length_m);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Point3DId id = Point3DIdFromCorner({marker_id, corner});
    Point3D& point = model->points3D[id];
    point.x_in_world = world_from_marker * corners[corner - 1];
    point.color = {static_cast<std::uint8_t>(10 * marker_id % 256),
                   static_cast<std::uint8_t>(corner), 200};
    for (ModelImage& image : model->images) {
      const auto x_in_image_px =
          ImageFromCam(model->cameras.at(1), image.cam_from_world * point.x_in_world);
      point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
      image.points2D.push_back({x_in_image_px.value(), id});
    }
  }
}

}  // namespace

Layout ExampleLayout() {
  Layout layout = MakeLayout("DICT_4X4_250", kLength_m);
  layout.marker_lengths_m[121] = kSmallLength_m;
  LayoutPart sail;
  sail.name = "sail";
  sail.horizontal = {{"h1", {1, 2, 3}}, {"h2", {4, 5, 6}}};
  LayoutPart hull;
  hull.name = "hull";
  hull.rigid = true;
  hull.marker_ids = {120, 121};
  layout.parts = {sail, hull};
  return layout;
}

Model ExampleModel() {
  Model model;
  model.cameras[1] = {CameraModel::kPinhole, 1920, 1080, {1500, 1500, 960, 540}};
  ImageId image_id = 1;
  for (const double x : {-1.0, 0.0, 1.0}) {
    ModelImage image;
    image.image_id = image_id;
    image.camera_id = 1;
    image.name = "image" + std::to_string(image_id++) + ".jpg";
    image.cam_from_world = CamFromWorld({x, 0.1 * x, 6}, -0.2 * x);
    model.images.push_back(image);
  }
  for (const int marker_id : {1, 2, 3, 4, 5, 6, 120}) AddMarker(marker_id, kLength_m, &model);
  AddMarker(121, kSmallLength_m, &model);
  return model;
}

void AddImageNoise(double max_px, std::uint32_t seed, Model* model) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return max_px * (2.0 * random() / 4294967295.0 - 1.0); };
  for (ModelImage& image : model->images) {
    for (Point2D& point : image.points2D) {
      point.x_in_image_px.x() += uniform();
      point.x_in_image_px.y() += uniform();
    }
  }
}

ShapeMarker SquareMarker(int marker_id, double length_m, const Rigid3& shape_from_marker) {
  ShapeMarker marker;
  marker.marker_id = marker_id;
  marker.x_in_shape_m[0] = shape_from_marker.translation;
  const auto corners = CornersInMarker(length_m);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    marker.x_in_shape_m[corner] = shape_from_marker * corners[corner - 1];
  }
  marker.num_frames.fill(3);
  return marker;
}

Sim3 ExampleSim3(double scale) {
  // The shift is proportional to the scale, because a small model far from the origin loses digits.
  const Eigen::Vector3d translation = scale * Eigen::Vector3d(3.0, -7.0, 11.0);
  return {scale, Eigen::Quaterniond(0.8, 0.3, -0.4, 0.1).normalized(), translation};
}

std::string Written(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

}  // namespace velamap
