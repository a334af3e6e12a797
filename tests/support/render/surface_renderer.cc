#include "tests/support/render/surface_renderer.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "tests/support/render/coverage_image.h"
#include "tests/support/render/picture_effects.h"
#include "tests/support/render/shadows.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

// Every frame needs the same pictures of up to hundreds of MB. New pages for them would take more
// than half of the time, so freed memory is kept, in one arena for all threads.
const struct FreedMemoryIsKept {
  FreedMemoryIsKept() {
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  }
} freed_memory_is_kept;

constexpr double kFullLight = 255.0;

struct Vertex {
  Eigen::Vector3d x_in_world;
  std::optional<Eigen::Vector2d> x_in_image_px;
};

// One frame's view of the scene.
class FrameView {
 public:
  FrameView(const ClipScene& scene, int frame_idx)
      : scene_(scene),
        cam_from_world_(scene.cam_from_world(frame_idx)),
        frame_idx_(frame_idx),
        readout_frames_(scene.options.rolling_shutter_s * scene.options.fps) {}

  // The pose while the middle row is read.
  const Rigid3& cam_from_world() const { return cam_from_world_; }

  std::optional<Eigen::Vector2d> Image(const Eigen::Vector3d& x_in_world) const {
    return ImageFromCam(scene_.camera, cam_from_world_ * x_in_world);
  }

  // World and image at the time when the row is read in which the vertex is then seen.
  Vertex See(const ClipVertex& vertex) const {
    Vertex seen{PositionInFrame(scene_, vertex, frame_idx_), {}};
    seen.x_in_image_px = Image(seen.x_in_world);
    if (readout_frames_ == 0) return seen;
    // Each pass leaves of the error what the picture moves by while the rows of the motion are
    // read: a hundredth in fast motion.
    constexpr int kNumPasses = 5;
    for (int pass = 0; pass < kNumPasses && seen.x_in_image_px; ++pass) {
      const double row = seen.x_in_image_px->y() / scene_.camera.height_px;
      const double frame = frame_idx_ + readout_frames_ * (std::clamp(row, 0.0, 1.0) - 0.5);
      seen.x_in_world = PositionInFrame(scene_, vertex, frame);
      seen.x_in_image_px =
          ImageFromCam(scene_.camera, scene_.cam_from_world(frame) * seen.x_in_world);
    }
    return seen;
  }

 private:
  const ClipScene& scene_;
  Rigid3 cam_from_world_;
  int frame_idx_;
  double readout_frames_;  // between the first row and the last
};

// Light from the upper left, behind the camera.
double Shade(const Eigen::Vector3d& normal) {
  static const Eigen::Vector3d light = Eigen::Vector3d(-0.5, -0.7, 0.5).normalized();
  return 0.7 + 0.3 * std::max(0.0, normal.normalized().dot(light));
}

struct Patch {
  ImageQuad quad;  // of the fine picture
  double shade;
};

// Nothing for a patch that turns its back or reaches behind the camera. Corners clockwise.
std::optional<Patch> MakePatch(const std::array<const Vertex*, 4>& corners) {
  Patch patch;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i]->x_in_image_px) return std::nullopt;
    patch.quad[i] = kFinePerSensorPx * *corners[i]->x_in_image_px;
  }
  if (SignedArea(patch.quad) <= 0) return std::nullopt;
  patch.shade = Shade((corners[3]->x_in_world - corners[1]->x_in_world)
                          .cross(corners[2]->x_in_world - corners[0]->x_in_world));
  return patch;
}

template <typename Vertices>
std::vector<Vertex> ProjectVertices(const FrameView& view, const Vertices& vertices) {
  std::vector<Vertex> projected;
  projected.reserve(vertices.size());
  for (const ClipVertex& vertex : vertices) projected.push_back(view.See(vertex));
  return projected;
}

// Calls draw(column, row, patch) for every patch that faces the camera.
template <typename Draw>
void ForEachPatch(const FrameView& view, const ClipSheet& sheet, const Draw& draw) {
  const std::vector<Vertex> vertices = ProjectVertices(view, sheet.vertices);
  const int stride = sheet.num_columns + 1;
  for (int row = 0; row < sheet.num_rows; ++row) {
    for (int column = 0; column < sheet.num_columns; ++column) {
      const Vertex* top_left = vertices.data() + row * stride + column;
      const auto patch =
          MakePatch({top_left, top_left + 1, top_left + stride + 1, top_left + stride});
      if (patch) draw(column, row, *patch);
    }
  }
}

void DrawMarker(const FrameView& view, const ClipMarker& marker,
                const SurfaceRenderOptions& options, CoverageImage* image) {
  const double ink = kFullLight * options.ink_level, paper = kFullLight * options.paper_level;
  ForEachPatch(view, marker.sheet, [&](int column, int row, const Patch& patch) {
    const bool inked = marker.inked.at<std::uint8_t>(row, column) != 0;
    image->Add(patch.quad, patch.shade * ((inked ? ink : paper) - marker.ground_gray), 0.0);
  });
}

// A surface that folds over itself counts twice.
void CountFoldsOnce(cv::Mat* surfaces) {
  surfaces->forEach<cv::Vec2f>([](cv::Vec2f& sums, const int*) {
    if (sums[1] > 1) sums /= sums[1];
  });
}

// Grey levels, times opacity, and opacity (CV_32FC2) in the fine picture.
cv::Mat DrawSurfaces(const ClipScene& scene, const FrameView& view,
                     const SurfaceRenderOptions& options) {
  CoverageImage image(kFinePerSensorPx * scene.camera.width_px,
                      kFinePerSensorPx * scene.camera.height_px);
  for (const ClipSheet& sheet : scene.sheets) {
    ForEachPatch(view, sheet, [&](int, int, const Patch& patch) {
      image.Add(patch.quad, patch.shade * sheet.gray, 1.0);
    });
  }
  for (const ClipPaint& paint : scene.paint) {
    const std::vector<Vertex> corners = ProjectVertices(view, paint.corners);
    const auto patch = MakePatch({&corners[0], &corners[1], &corners[2], &corners[3]});
    if (patch) image.Add(patch->quad, patch->shade * paint.gray_change, 0.0);
  }
  for (const ClipMarker& marker : scene.markers) DrawMarker(view, marker, options, &image);
  cv::Mat surfaces = image.Resolve();
  CountFoldsOnce(&surfaces);
  return surfaces;
}

// A fine picture as lens, motion and the means over the sensor's pixels leave it.
cv::Mat Exposed(const SurfaceRenderOptions& options, int frame_idx, cv::Mat fine) {
  constexpr double kGoldenAngle_rad = 2.399963;
  MotionBlur(options.motion_blur_px, kGoldenAngle_rad * frame_idx, &fine);
  LensBlur(options.blur_px, &fine);
  DefocusBlur(options.defocus_px, &fine);
  cv::Mat image = OnSensor(fine);
  Halo(options.halo, options.halo_px, &image);
  return image;
}

// BGR of the far world in a direction: sea, haze at the horizon, sky.
cv::Vec3f FarColor(const Eigen::Vector3d& direction) {
  const double height = direction.normalized().z();
  const cv::Vec3f haze(214, 206, 196), sky(190, 140, 95), sea(92, 78, 56);
  const auto clear = static_cast<float>(std::clamp(1.6 * height, 0.0, 1.0));
  // The horizon is wider than the lattice of DrawSky, which would show as stairs otherwise.
  const auto above = static_cast<float>(std::clamp(height / 0.08 + 1.0, 0.0, 1.0));
  return above * (haze + clear * (sky - haze)) + (1 - above) * sea;
}

cv::Mat DrawSky(const ClipScene& scene, const FrameView& view) {
  constexpr int kPitchPx = 16;
  const Camera& camera = scene.camera;
  cv::Mat coarse(camera.height_px / kPitchPx, camera.width_px / kPitchPx, CV_32FC3);
  const Eigen::Quaterniond world_from_cam = view.cam_from_world().rotation.conjugate();
  for (int row = 0; row < coarse.rows; ++row) {
    for (int column = 0; column < coarse.cols; ++column) {
      const auto ray = CamFromImage(camera, {(column + 0.5) * camera.width_px / coarse.cols,
                                             (row + 0.5) * camera.height_px / coarse.rows});
      const Eigen::Vector3d in_cam = ray.value_or(Eigen::Vector2d::Zero()).homogeneous();
      coarse.at<cv::Vec3f>(row, column) = FarColor(world_from_cam * in_cam);
    }
  }
  cv::Mat sky;
  cv::resize(coarse, sky, {camera.width_px, camera.height_px}, 0, 0, cv::INTER_LINEAR);
  return sky;
}

// Boards and squares of all kinds on a plane behind the scene, some in a white frame as a marker.
void DrawClutter(const ClipScene& scene, const FrameView& view, cv::Mat* fine) {
  constexpr int kShift = 4;
  std::mt19937 random(scene.options.seed + 29);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  const double behind_m = 0.8 * scene.options.distance_m;
  const auto draw = [&](const Eigen::Vector2d& middle_m, const Eigen::Vector2d& half_m, double skew,
                        const cv::Scalar& color) {
    std::vector<cv::Point> corners;
    for (const auto& [right, up] : {std::pair{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}) {
      const auto x = view.Image({middle_m.x() + right * half_m.x() + skew * up, behind_m,
                                 middle_m.y() + up * half_m.y()});
      if (!x || x->norm() > 4 * scene.camera.width_px) return;
      const Eigen::Vector2d shifted =
          (kFinePerSensorPx * *x - Eigen::Vector2d::Constant(0.5)) * (1 << kShift);
      corners.emplace_back(static_cast<int>(std::lround(shifted.x())),
                           static_cast<int>(std::lround(shifted.y())));
    }
    cv::fillConvexPoly(*fine, corners, color, cv::LINE_8, kShift);
  };
  const double reach_m = 2.2 * scene.options.distance_m;
  for (int i = 0; i < 260; ++i) {
    const Eigen::Vector2d middle_m(between(-reach_m, reach_m), between(-0.5 * reach_m, reach_m));
    const double size_m = scene.options.distance_m * between(0.005, 0.05);
    const Eigen::Vector2d half_m(size_m * between(0.3, 1.6), size_m);
    const double skew = between(-0.3, 0.3) * size_m, gray = between(20, 235);
    const cv::Scalar color(gray, gray * between(0.7, 1), gray * between(0.7, 1));
    if (i % 3 == 0) draw(middle_m, 1.4 * half_m, skew, {230, 230, 230});
    draw(middle_m, half_m, skew, color);
    if (i % 3 == 0) draw(middle_m, 0.3 * half_m, 0.3 * skew, {230, 230, 230});
  }
}

// Composites the surfaces over the background.
void Compose(const cv::Mat& surfaces, cv::Mat* image) {
  for (int row = 0; row < image->rows; ++row) {
    const cv::Vec2f* sums = surfaces.ptr<cv::Vec2f>(row);
    cv::Vec3f* pixels = image->ptr<cv::Vec3f>(row);
    for (int column = 0; column < image->cols; ++column) {
      pixels[column] = cv::Vec3f::all(sums[column][0]) + (1 - sums[column][1]) * pixels[column];
    }
  }
}

// One patch of mirrored sunlight around `middle`. Its glare falls off as exp(-r^2) in the frame of
// the patch. Nothing is drawn of a patch that is seen edge-on.
void DrawReflection(const Eigen::Vector2d& middle, const Eigen::Matrix2d& image_from_patch,
                    const cv::Mat& surfaces, cv::Mat* image) {
  constexpr double kMaxRadius2 = 6;  // beyond it nothing is seen of a patch
  if (std::abs(image_from_patch.determinant()) < 1) return;
  const Eigen::Vector2d reach = std::sqrt(kMaxRadius2) * image_from_patch.rowwise().norm();
  const cv::Rect box = cv::Rect(cv::Point(middle.x() - reach.x(), middle.y() - reach.y()),
                                cv::Point(middle.x() + reach.x(), middle.y() + reach.y())) &
                       cv::Rect({}, image->size());
  const Eigen::Matrix2d patch_from_image = image_from_patch.inverse();
  for (int row = box.y; row < box.y + box.height; ++row) {
    cv::Vec3f* pixels = image->ptr<cv::Vec3f>(row);
    const cv::Vec2f* sums = surfaces.ptr<cv::Vec2f>(row);
    for (int column = box.x; column < box.x + box.width; ++column) {
      const Eigen::Vector2d offset(column + 0.5 - middle.x(), row + 0.5 - middle.y());
      const double radius2 = (patch_from_image * offset).squaredNorm();
      if (radius2 > kMaxRadius2) continue;
      const double glare = sums[column][1] * std::min(1.0, 1.4 * std::exp(-radius2));
      pixels[column] += static_cast<float>(glare) * (cv::Vec3f::all(252) - pixels[column]);
    }
  }
}

// The vertex of a sheet next to a place, which runs from 0 to 1 to the right and upwards.
Vertex SeeOnSheet(const FrameView& view, const ClipSheet& sheet, const Eigen::Vector2d& place) {
  const int column =
      std::clamp(static_cast<int>(place.x() * sheet.num_columns), 0, sheet.num_columns);
  const int row = std::clamp(static_cast<int>((1 - place.y()) * sheet.num_rows), 0, sheet.num_rows);
  return view.See(sheet.vertices[static_cast<std::size_t>(row * (sheet.num_columns + 1) + column)]);
}

// Shadows on the last sheet (the sail), and on what the picture shows in line with them.
void AddShadows(const ClipScene& scene, const FrameView& view, const SurfaceRenderOptions& options,
                double clip_share, cv::Mat* surfaces) {
  constexpr double kHalfLength = 0.15;
  const ClipSheet& sheet = scene.sheets.back();
  for (const Shadow& shadow :
       DrawShadows(options.num_shadows, options.shadow_depth, scene.options.seed)) {
    const Eigen::Vector2d place = shadow.place + clip_share * shadow.motion_in_clip;
    const Vertex from = SeeOnSheet(view, sheet, place - kHalfLength * shadow.direction);
    const Vertex to = SeeOnSheet(view, sheet, place + kHalfLength * shadow.direction);
    if (!from.x_in_image_px || !to.x_in_image_px) continue;
    const Eigen::Vector2d from_px = kFinePerSensorPx * *from.x_in_image_px;
    const Eigen::Vector2d to_px = kFinePerSensorPx * *to.x_in_image_px;
    const double length_m = (to.x_in_world - from.x_in_world).norm();
    if (length_m > 0)
      AddShadow(shadow, from_px, to_px, (to_px - from_px).norm() / length_m, surfaces);
  }
}

// Mirrored sunlight: patches that wander over the last sheet (the sail) as the camera moves.
void AddReflections(const ClipScene& scene, const FrameView& view, int num_reflections,
                    const cv::Mat& surfaces, cv::Mat* image) {
  const ClipSheet& sheet = scene.sheets.back();
  const Eigen::Vector3d eye_m = Inverse(view.cam_from_world()).translation;
  const double turn = std::atan2(eye_m.x(), -eye_m.y());
  const auto in_image = [&](double u, double v) {
    return SeeOnSheet(view, sheet, {u, v}).x_in_image_px;
  };
  for (int i = 0; i < num_reflections; ++i) {
    const double u = std::fmod(0.34 + 0.381966 * i, 0.8) + 0.1 - 0.15 * turn;
    const double v = std::fmod(0.22 + 0.618034 * i, 0.7) + 0.08;
    const auto middle = in_image(u, v), right = in_image(u + 0.16, v), up = in_image(u, v + 0.12);
    if (!middle || !right || !up) continue;
    Eigen::Matrix2d image_from_patch;
    image_from_patch << *right - *middle, *up - *middle;
    DrawReflection(*middle, image_from_patch, surfaces, image);
  }
}

}  // namespace

void SurfaceRenderOptions::Check() const {
  CheckOptionRange("blur_px", blur_px, 0, 20);
  CheckOptionRange("defocus_px", defocus_px, 0, 20);
  CheckOptionRange("halo", halo, 0, 0.9);
  CheckOptionRange("halo_px", halo_px, 1, 20);
  CheckOptionRange("motion_blur_px", motion_blur_px, 0, 100);
  CheckOptionRange("noise", noise, 0, 100);
  CheckOptionRange("shot_noise", shot_noise, 0, 100);
  CheckOptionRange("reflection", num_reflections, 0, 20);
  CheckOptionRange("shadows", num_shadows, 0, 100);
  CheckOptionRange("shadow_depth", shadow_depth, 0, 0.95);
  CheckOptionRange("glare", glare, 0, 0.5);
  CheckOptionRange("ink_level", ink_level, 0.01, 0.5);
  CheckOptionRange("paper_level", paper_level, 0.5, 1);
  response.Check();
}

cv::Mat RenderClipFrame(const ClipScene& scene, const SurfaceRenderOptions& options,
                        int frame_idx) {
  const FrameView view(scene, frame_idx);
  cv::Mat fine_surfaces = DrawSurfaces(scene, view, options);
  AddShadows(scene, view, options, static_cast<double>(frame_idx) / scene.options.num_frames,
             &fine_surfaces);
  const cv::Mat surfaces = Exposed(options, frame_idx, fine_surfaces);
  cv::Mat image = DrawSky(scene, view);  // smooth, so that blur does not change it
  if (scene.options.busy) {
    cv::Mat fine;
    cv::resize(image, fine, image.size() * kFinePerSensorPx, 0, 0, cv::INTER_LINEAR);
    DrawClutter(scene, view, &fine);
    image = Exposed(options, frame_idx, fine);
  }
  Compose(surfaces, &image);
  AddReflections(scene, view, options.num_reflections, surfaces, &image);
  if (options.glare > 0) image += cv::Scalar::all(kFullLight * options.glare);
  const auto seed = static_cast<std::uint64_t>(scene.options.seed) << 32;
  AddNoise(options.noise, options.shot_noise, seed + static_cast<std::uint64_t>(frame_idx) + 1,
           &image);
  ApplyResponse(options.response, &image);
  image.convertTo(image, CV_8U);
  return image;
}

std::optional<std::array<Eigen::Vector2d, kNumCorners>> ProjectCorners(const ClipScene& scene,
                                                                       const ClipMarker& marker,
                                                                       int frame_idx) {
  const FrameView view(scene, frame_idx);
  std::array<Eigen::Vector2d, kNumCorners> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto x = view.See(marker.corners[i]).x_in_image_px;
    if (!x || x->minCoeff() < 0 || x->x() > scene.camera.width_px ||
        x->y() > scene.camera.height_px) {
      return std::nullopt;
    }
    corners[i] = *x;
  }
  if (SignedArea(corners) <= 0) return std::nullopt;
  return corners;
}

}  // namespace velamap
