#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/formation/formation_estimation.h"
#include "importer/geometry/units.h"
#include "tests/importer/formation/formation_scenes.h"
#include "tests/support/clip/clip_scene_builder.h"
#include "tests/support/study/photographed_grid.h"

namespace velamap {
namespace {

constexpr int kNumColumns = 5, kNumRows = 4;

// A flat sheet with markers of this size, all printed with the same spread of the ink, and seen at
// a slant by a camera with a tone curve.
MarkerGrid PhotographSheet(double marker_m, double side_px) {
  ClipOptions options;
  options.num_frames = 1;
  options.ink_spread_mm = 0.2;
  const double width_m = 2.2 * marker_m * kNumColumns, height_m = 2.2 * marker_m * kNumRows;
  const Surface flat = [=](const Eigen::Vector2d& uv) {
    return Eigen::Vector3d(width_m * (uv.x() - 0.5), 0, height_m * (uv.y() - 0.5));
  };
  const Ground ground{flat, flat};
  ClipSceneBuilder builder(options, marker_m);
  builder.AddSheet(ground, 1, 1);
  for (int i = 0; i < kNumColumns * kNumRows; ++i) {
    builder.AddMarker(ground, "",
                      {(i % kNumColumns + 0.5) / kNumColumns, (i / kNumColumns + 0.5) / kNumRows});
  }
  ClipScene& scene = builder.scene();
  const double px_per_m = side_px / marker_m;
  const int width_px = static_cast<int>(1.3 * width_m * px_per_m);
  const double focal_px = 1.5 * width_px;
  scene.camera = {CameraModel::kPinhole,
                  width_px,
                  width_px,
                  {focal_px, focal_px, 0.5 * width_px, 0.5 * width_px}};
  const Eigen::Quaterniond cam_from_world =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(90 * kRadPerDeg, Eigen::Vector3d::UnitX());
  const Rigid3 pose{cam_from_world, {0, 0, focal_px / px_per_m}};
  scene.cam_from_world = [pose](double) { return pose; };

  SurfaceRenderOptions rendering;
  rendering.noise = 1.0;
  rendering.response.tone_curve = ToneCurveKind::kSrgb;
  return PhotographedGrid(scene, rendering);
}

struct Sheet {
  MarkerGrid grid;
  double side_mm;
};

// The largest error of the sides of a sheet, where the markers are taken to be as large as
// `side_mm_of` says.
template <typename SideOf>
double LargestBias(const std::vector<Sheet>& sheets, const SideOf& side_mm_of) {
  std::vector<FormationSample> samples;
  for (const Sheet& sheet : sheets) {
    for (FormationSample sample : Samples(sheet.grid)) {
      sample.marker.side_mm = side_mm_of(sheet);
      samples.push_back(sample);
    }
  }
  const FormationEstimate estimate = EstimateFormation(samples, false);
  double largest = 0.0;
  for (const Sheet& sheet : sheets) {
    const double bias_px =
        SideBias(sheet.grid, ImageFormation(estimate.parameters), side_mm_of(sheet));
    largest = std::max(largest, std::abs(bias_px));
  }
  return largest;
}

// Of a print whose markers have two sizes, the ink is a larger share of the smaller ones.
TEST(FormationEstimation, InkIsALengthOnThePaper) {
  const std::vector<Sheet> sheets = {{PhotographSheet(0.3, 80), 300},
                                     {PhotographSheet(0.05, 40), 50}};
  const double bias_px = LargestBias(sheets, [](const Sheet& sheet) { return sheet.side_mm; });
  const double as_share_px = LargestBias(sheets, [](const Sheet&) { return 100.0; });
  EXPECT_LT(bias_px, 0.03);
  EXPECT_LT(bias_px, 0.5 * as_share_px);
  RecordProperty("bias_px", std::to_string(bias_px) + " " + std::to_string(as_share_px));
}

}  // namespace
}  // namespace velamap
