// Time of detection in one thread: the whole frame, and the corner refinement by itself.

#include <benchmark/benchmark.h>

#include "importer/refine/corner_refinement.h"
#include "tests/support/detect_markers.h"
#include "tests/support/render/marker_renderer.h"

namespace velamap {
namespace {

struct Picture {
  SyntheticScene scene;
  Dictionary dictionary;
  cv::Mat gray;
};

// A frame of a sail of 40 markers; `width_px` sets the resolution, the field of view stays.
Picture RenderPicture(int width_px) {
  const double scale = width_px / 1920.0;
  SyntheticSceneOptions options;
  options.num_columns = 8;
  options.num_frames = 3;
  options.camera = {CameraModel::kOpenCV,
                    width_px,
                    width_px * 9 / 16,
                    {1200 * scale, 1200 * scale, 960 * scale, 540 * scale, -0.1, 0.03, 0, 0}};
  Picture picture{MakeSyntheticScene(options), {}, {}};
  picture.dictionary = LoadDictionary(picture.scene.layout.dictionary);
  RenderOptions render;
  render.noise_sigma = 2.0;
  render.background_texture = 20.0;
  picture.gray = RenderFrame(picture.scene, 1, render);
  return picture;
}

// Arguments: width of the frame, corner refinement (0 none, 1 subpix, 2 edge).
void BM_DetectMarkers(benchmark::State& state) {
  const Picture picture = RenderPicture(static_cast<int>(state.range(0)));
  ArucoDetectionOptions options;
  options.corner_refinement = static_cast<CornerRefinement>(state.range(1));
  std::size_t num_markers = 0;
  cv::setNumThreads(1);
  for (auto _ : state) {
    num_markers = DetectMarkers(picture.gray, picture.dictionary, 1, options).size();
  }
  state.counters["markers"] = static_cast<double>(num_markers);
}
BENCHMARK(BM_DetectMarkers)
    ->ArgsProduct({{1280, 1920, 3840}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond);

// The whole of a 4K frame; arguments: rows and columns of markers, which grow smaller.
void BM_DetectManyMarkers(benchmark::State& state) {
  SyntheticSceneOptions options;
  options.num_rows = static_cast<int>(state.range(0));
  options.num_columns = static_cast<int>(state.range(1));
  options.num_frames = 1;
  options.spacing_m = 3.0 / options.num_columns;
  options.marker_length_m = 0.6 * options.spacing_m;
  options.camera = {CameraModel::kPinhole, 3840, 2160, {2400, 2400, 1920, 1080}};
  SyntheticScene scene = MakeSyntheticScene(options);
  scene.layout.dictionary = "DICT_4X4_1000";
  RenderOptions render;
  render.noise_sigma = 2.0;
  const Dictionary dictionary = LoadDictionary(scene.layout.dictionary);
  const cv::Mat gray = RenderFrame(scene, 0, render);
  std::size_t num_markers = 0;
  cv::setNumThreads(1);
  for (auto _ : state) num_markers = DetectMarkers(gray, dictionary, 1, {}).size();
  state.counters["markers"] = static_cast<double>(num_markers);
}
BENCHMARK(BM_DetectManyMarkers)
    ->Args({4, 5})
    ->Args({5, 13})
    ->Args({10, 13})
    ->Args({20, 13})
    ->Args({20, 25})
    ->Unit(benchmark::kMillisecond);

// All markers of a 1920x1080 frame, from corners off by 0.7 px.
void BM_RefineCornersBySides(benchmark::State& state) {
  const Eigen::Vector2d kOpenCvFromImagePx(-0.5, -0.5), kOffsetPx(0.5, -0.5);
  const Picture picture = RenderPicture(1920);
  const auto& markers = picture.scene.frames[1].markers;
  const int num_cells = picture.dictionary.aruco->markerSize + 2;
  for (auto _ : state) {
    for (const MarkerDetection& marker : markers) {
      auto corners_px = marker.corners_in_image_px;
      for (auto& corner : corners_px) corner += kOpenCvFromImagePx + kOffsetPx;
      benchmark::DoNotOptimize(RefineCornersBySides(picture.gray, corners_px, num_cells));
    }
  }
  state.counters["markers/s"] = benchmark::Counter(static_cast<double>(markers.size()),
                                                   benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_RefineCornersBySides)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace velamap
