// Time of the marker-aware bundle adjustment, all of its rounds and the covariance; beside it
// COLMAP's program (with velamap's outlier rounds) from the same seed. A sail of 130 markers, 41
// frames.

#include <benchmark/benchmark.h>

#include "reconstruct/bundle_adjustment.h"
#include "reconstruct/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

SyntheticScene Sail() {
  SyntheticSceneOptions options;
  options.num_rows = 10;
  options.num_columns = 13;
  options.spacing_m = 0.2;
  options.num_frames = 41;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.2, 0.05, 0.005, 200, 1}, &scene);
  return scene;
}

Model Seed(const SyntheticScene& scene) {
  Model model = MakeSceneModel(scene);
  PerturbSeed(0.001, 1, &model);  // 4 mm
  return model;
}

void BM_MarkerAdjustment(benchmark::State& state) {
  const SyntheticScene scene = Sail();
  const Model seed = Seed(scene);
  int num_iterations = 0;
  for (auto _ : state) {
    Model model = seed;
    num_iterations = AdjustWithCeres({}, scene.layout, {}, &model).num_iterations;
  }
  state.counters["iterations"] = num_iterations;
}
BENCHMARK(BM_MarkerAdjustment)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_ColmapFromTheSameSeed(benchmark::State& state) {
  const Model seed = Seed(Sail());
  const TempDir folder;
  for (auto _ : state) {
    Model model = seed;
    AdjustWithColmap({}, (folder / "colmap.log").string(), &model);
  }
}
BENCHMARK(BM_ColmapFromTheSameSeed)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace velamap
