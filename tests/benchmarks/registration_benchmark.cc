// Time of all stages after the database: registration, COLMAP's bundle adjustment, export.
// A sail of 120 markers; the argument is the number of frames of the clip.

#include <benchmark/benchmark.h>

#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/global/global_registration.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "tests/reconstruct/registration_fixture.h"
#include "tests/support/export_shape.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

SyntheticScene RegisteredSail(int num_frames) {
  SyntheticSceneOptions options;
  options.num_rows = 8;
  options.num_columns = 15;
  options.spacing_m = 0.2;
  options.num_frames = num_frames;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.2, 0.05, 0.005, 200, 1}, &scene);
  return scene;
}

Model SeedOf(const SyntheticScene& scene) {
  const auto images = DatabaseImages(scene);
  const auto cameras = SceneCameras(scene);
  return MakeSeedModel(RegisterFrames(images, cameras, scene.layout, {}), images, cameras);
}

void BM_ThesisRegistration(benchmark::State& state) {
  const SyntheticScene scene = RegisteredSail(static_cast<int>(state.range(0)));
  const auto images = DatabaseImages(scene);
  const auto cameras = SceneCameras(scene);
  RegistrationOptions options;
  options.method = RegistrationMethod::kThesis;
  for (auto _ : state) {
    benchmark::DoNotOptimize(RegisterFrames(images, cameras, scene.layout, options));
  }
}
BENCHMARK(BM_ThesisRegistration)
    ->Arg(41)
    ->Arg(200)
    ->Arg(600)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void BM_GlobalRegistration(benchmark::State& state) {
  const SyntheticScene scene = RegisteredSail(static_cast<int>(state.range(0)));
  const auto images = DatabaseImages(scene);
  const auto cameras = SceneCameras(scene);
  for (auto _ : state) {
    benchmark::DoNotOptimize(RegisterFramesGlobally(images, cameras, scene.layout, {}));
  }
}
BENCHMARK(BM_GlobalRegistration)
    ->Arg(41)
    ->Arg(80)
    ->Arg(200)
    ->Arg(600)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void BM_ColmapBundleAdjustment(benchmark::State& state) {
  const Model seed = SeedOf(RegisteredSail(static_cast<int>(state.range(0))));
  const TempDir folder;
  for (auto _ : state) {
    Model model = seed;
    AdjustWithColmap({}, (folder / "colmap.log").string(), &model);
  }
}
BENCHMARK(BM_ColmapBundleAdjustment)->Arg(41)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Export(benchmark::State& state) {
  const SyntheticScene scene = RegisteredSail(41);
  const Model model = SeedOf(scene);
  const TempDir folder;
  ShapeExporterOptions options;
  options.model_output_path = (folder / "model").string();
  options.shape_output_path = (folder / "shape").string();
  for (auto _ : state) ExportShape(model, scene.layout, options);
}
BENCHMARK(BM_Export)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace velamap
