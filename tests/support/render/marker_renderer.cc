#include "tests/support/render/marker_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/support/render/picture_effects.h"

namespace velamap {
namespace {

// Rays are exact on a lattice of this pitch and interpolated between: with a strong wide-angle
// distortion the error stays below 0.0003 px.
constexpr int kRayPitchPx = 2;

// The printed square with its rings; positions in cells from the black square's top-left corner,
// u to the right, v down.
class Print {
 public:
  Print(const Dictionary& dictionary, int border_bits, int marker_id, const RenderOptions& options)
      : num_cells_(CellsPerSide(dictionary, border_bits)),
        ring_(options.quiet_zone_cells),
        surround_(options.surround_cells) {
    MarkerCells(dictionary, marker_id, border_bits)
        .convertTo(cells_, CV_32F, (options.white - options.black) / 255.0, options.black);
    black_ = static_cast<float>(options.black);
    white_ = static_cast<float>(options.white);
  }

  int num_cells() const { return num_cells_; }
  double margin() const { return ring_ + surround_; }

  bool Covers(double u, double v) const { return Outside(u, v) < margin(); }

  float Gray(double u, double v) const {
    const double outside = Outside(u, v);
    if (outside >= ring_) return black_;
    if (outside >= 0) return white_;
    return cells_.at<float>(static_cast<int>(v), static_cast<int>(u));
  }

  // Whether no boundary between cells or rings lies within the given distances of (u, v).
  bool IsUniform(double u, double v, double reach_u, double reach_v) const {
    return !CrossesLine(u, reach_u) && !CrossesLine(v, reach_v);
  }

 private:
  // How far a place lies outside the black square; negative inside.
  double Outside(double u, double v) const {
    return std::max({-u, u - num_cells_, -v, v - num_cells_});
  }

  bool CrossesLine(double x, double reach) const {
    const double low = x - reach, high = x + reach;
    const auto crosses = [&](double line) { return low < line && line <= high; };
    const bool near_square = high >= 0 && low <= num_cells_;
    return (near_square && std::floor(low) != std::floor(high)) || crosses(-ring_) ||
           crosses(num_cells_ + ring_) || crosses(-margin()) || crosses(num_cells_ + margin());
  }

  int num_cells_;
  double ring_, surround_;
  cv::Mat cells_;
  float black_, white_;
};

// Where the ray through a place of the image meets the marker's plane.
struct MarkerPlane {
  Eigen::Matrix3d marker_from_ray;  // homogeneous (u, v) in cells of a ray (x, y, 1)

  MarkerPlane(const PlacedMarkerInCam& marker, int num_cells) {
    const auto& corners = marker.corners_in_cam;
    Eigen::Matrix3d ray_from_marker;
    ray_from_marker << (corners[1] - corners[0]) / num_cells, (corners[3] - corners[0]) / num_cells,
        corners[0];
    marker_from_ray = ray_from_marker.inverse();
  }

  Eigen::Vector2d operator()(const Eigen::Vector2d& ray) const {
    return (marker_from_ray * ray.homogeneous()).hnormalized();
  }
};

bool IsVisible(const PlacedMarkerInCam& marker) {
  const auto& corners = marker.corners_in_cam;
  const Eigen::Vector3d away = (corners[1] - corners[0]).cross(corners[3] - corners[0]);
  return away.dot(corners[0]) > 0 &&
         std::all_of(corners.begin(), corners.end(), [](const auto& x) { return x.z() > 0; });
}

// Pixels that the print can touch; the outline is followed in steps because distortion bends it.
cv::Rect BoundingBox(const Camera& camera, const PlacedMarkerInCam& marker, const Print& print) {
  constexpr int kSteps = 8;
  const auto& corners = marker.corners_in_cam;
  const double margin = print.margin() / print.num_cells();
  Eigen::AlignedBox2d touched;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const double u = -margin + (1 + 2 * margin) * i / kSteps;
      const double v = -margin + (1 + 2 * margin) * j / kSteps;
      const auto x = ImageFromCam(
          camera, corners[0] + u * (corners[1] - corners[0]) + v * (corners[3] - corners[0]));
      if (x) touched.extend(*x);
    }
  }
  const Eigen::Vector2d size(camera.width_px, camera.height_px);
  const auto clamped = [&](const Eigen::Vector2d& x) {
    return x.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(size).eval();
  };
  const Eigen::Vector2d low = clamped(touched.min() - Eigen::Vector2d::Constant(2));
  const Eigen::Vector2d high = clamped(touched.max() + Eigen::Vector2d::Constant(2));
  const cv::Point first(static_cast<int>(low.x()), static_cast<int>(low.y()));
  return {first, cv::Point(static_cast<int>(high.x()), static_cast<int>(high.y()))};
}

// Rays at the lattice's places, from the box's first pixel corner; NaN where there is none.
class RayLattice {
 public:
  RayLattice(const Camera& camera, const cv::Rect& box)
      : columns_(box.width / kRayPitchPx + 2), first_(box.x, box.y) {
    const int rows = box.height / kRayPitchPx + 2;
    rays_.reserve(static_cast<std::size_t>(columns_) * rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Eigen::Vector2d place = first_ + kRayPitchPx * Eigen::Vector2d(column, row);
        rays_.push_back(
            CamFromImage(camera, place)
                .value_or(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN())));
      }
    }
  }

  Eigen::Vector2d operator()(double x_px, double y_px) const {
    const double x = (x_px - first_.x()) / kRayPitchPx, y = (y_px - first_.y()) / kRayPitchPx;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const double fx = x - column, fy = y - row;
    const Eigen::Vector2d* upper = rays_.data() + row * columns_ + column;
    const Eigen::Vector2d* lower = upper + columns_;
    return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
           fy * ((1 - fx) * lower[0] + fx * lower[1]);
  }

 private:
  int columns_;
  Eigen::Vector2d first_;
  std::vector<Eigen::Vector2d> rays_;
};

// Samples of a unit square, no two with the same x or the same y, so that an upright edge is placed
// to within 1 / (2 n^2) px.
std::vector<Eigen::Vector2d> SamplePattern(int n) {
  std::vector<Eigen::Vector2d> offsets;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      offsets.emplace_back((i + (j + 0.5) / n) / n, (j + (i + 0.5) / n) / n);
    }
  }
  return offsets;
}

void DrawPrint(const Camera& camera, const PlacedMarkerInCam& marker, const Print& print,
               const std::vector<Eigen::Vector2d>& pattern, cv::Mat* image) {
  const MarkerPlane plane(marker, print.num_cells());
  const cv::Rect box = BoundingBox(camera, marker, print);
  const RayLattice rays(camera, box);
  for (int row = box.y; row < box.y + box.height; ++row) {
    float* pixels = image->ptr<float>(row);
    for (int column = box.x; column < box.x + box.width; ++column) {
      const Eigen::Vector2d ray = rays(column + 0.5, row + 0.5);
      if (!ray.allFinite()) continue;
      const Eigen::Vector2d center = plane(ray);
      const Eigen::Vector2d along_x = plane(rays(column + 1, row + 0.5)) - center;
      const Eigen::Vector2d along_y = plane(rays(column + 0.5, row + 1)) - center;
      const Eigen::Vector2d reach = 1.1 * (along_x.cwiseAbs() + along_y.cwiseAbs());
      if (print.IsUniform(center.x(), center.y(), reach.x(), reach.y())) {
        if (print.Covers(center.x(), center.y())) {
          pixels[column] = print.Gray(center.x(), center.y());
        }
        continue;
      }
      float sum = 0;
      for (const Eigen::Vector2d& offset : pattern) {
        const Eigen::Vector2d uv = plane(rays(column + offset.x(), row + offset.y()));
        sum += print.Covers(uv.x(), uv.y()) ? print.Gray(uv.x(), uv.y()) : pixels[column];
      }
      pixels[column] = sum / static_cast<float>(pattern.size());
    }
  }
}

cv::Mat MakeBackground(const cv::Size& size, const RenderOptions& options, cv::RNG* random) {
  constexpr int kPatchPx = 6 * kFinePerSensorPx;
  cv::Mat background(size, CV_32FC1, cv::Scalar(options.background));
  if (options.background_texture > 0) {
    cv::Mat coarse(size.height / kPatchPx + 1, size.width / kPatchPx + 1, CV_32FC1);
    random->fill(coarse, cv::RNG::NORMAL, 0.0, options.background_texture);
    cv::Mat texture;
    cv::resize(coarse, texture, size, 0, 0, cv::INTER_CUBIC);
    background += texture;
  }
  return background;
}

void ApplyLight(double gradient, cv::Mat* image) {
  const double diagonal = std::hypot(image->cols, image->rows);
  for (int row = 0; row < image->rows; ++row) {
    float* pixels = image->ptr<float>(row);
    for (int column = 0; column < image->cols; ++column) {
      const double along = (column - 0.5 * image->cols) + (row - 0.5 * image->rows);
      pixels[column] *= static_cast<float>(1 + gradient * along / diagonal);
    }
  }
}

void Sharpen(const ImageFormationParameters& camera, cv::Mat* image) {
  if (camera.sharpening == 0) return;
  cv::Mat blurred;
  cv::GaussianBlur(*image, blurred, {0, 0}, camera.sharpening_radius_px);
  *image = (1 + camera.sharpening) * *image - camera.sharpening * blurred;
}

// From light to grey values, as importer/pattern/formation_estimate.h has it but computed anew.
void ApplyCamera(const ImageFormationParameters& camera, bool sharpens_light, cv::Mat* image) {
  if (sharpens_light) Sharpen(camera, image);
  if (camera.gamma != 1 || camera.s_amplitude != 0) {
    image->forEach<float>([&camera](float& value, const int*) {
      const double v = std::pow(std::max(0.0, value / 255.0), 1 / camera.gamma);
      value = static_cast<float>(255 * (v - camera.s_amplitude * std::sin(2 * kPi * v)));
    });
  }
  if (!sharpens_light) Sharpen(camera, image);
}

}  // namespace

cv::Mat RenderMarkers(const Camera& camera, const std::vector<PlacedMarkerInCam>& markers,
                      const Dictionary& dictionary, int border_bits, const RenderOptions& options) {
  VELAMAP_CHECK(camera.width_px > 0 && camera.height_px > 0 && options.supersampling > 0);
  cv::RNG random(options.seed);
  const Camera fine_camera = FineCamera(camera);
  cv::Mat fine = MakeBackground({fine_camera.width_px, fine_camera.height_px}, options, &random);
  std::vector<PlacedMarkerInCam> far_first;
  std::copy_if(markers.begin(), markers.end(), std::back_inserter(far_first), IsVisible);
  std::stable_sort(far_first.begin(), far_first.end(), [](const auto& a, const auto& b) {
    const auto distance = [](const PlacedMarkerInCam& marker) {
      return (marker.corners_in_cam[1] + marker.corners_in_cam[3]).norm();
    };
    return distance(a) > distance(b);
  });
  const std::vector<Eigen::Vector2d> pattern = SamplePattern(options.supersampling);
  for (const PlacedMarkerInCam& marker : far_first) {
    const Print print(dictionary, border_bits, marker.marker_id, options);
    DrawPrint(fine_camera, marker, print, pattern, &fine);
  }
  LensBlur(options.blur_sigma_px, &fine);
  cv::Mat image = OnSensor(fine);
  if (options.light_gradient != 0) ApplyLight(options.light_gradient, &image);
  Halo(options.camera.halo, options.camera.halo_radius_px, &image);
  ApplyCamera(options.camera, options.sharpens_light, &image);
  if (options.noise_sigma > 0) {
    cv::Mat noise(image.size(), CV_32FC1);
    random.fill(noise, cv::RNG::NORMAL, 0.0, options.noise_sigma);
    image += noise;
  }
  image.convertTo(image, CV_8U);
  if (options.color) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
  return image;
}

cv::Mat RenderFrame(const SyntheticScene& scene, int frame_idx, const RenderOptions& options) {
  const Rigid3& cam_from_world = scene.cam_from_world.at(static_cast<std::size_t>(frame_idx));
  std::vector<PlacedMarkerInCam> markers;
  for (const auto& [marker_id, x_in_world] : scene.x_in_world) {
    PlacedMarkerInCam marker;
    marker.marker_id = marker_id;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      marker.corners_in_cam[i] = cam_from_world * x_in_world[i + 1];
    }
    markers.push_back(marker);
  }
  return RenderMarkers(scene.camera, markers, LoadDictionary(scene.layout.dictionary),
                       scene.layout.border_bits, options);
}

}  // namespace velamap
