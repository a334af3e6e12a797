// Time of registration and adjustment together, beside COLMAP's bundle_adjuster with its defaults
// from the same seed and with images in time order. In that order the scale runs away, and COLMAP
// stops at its limit of 100 iterations. "cpu_s" is the CPU time of all threads, of this process or
// of the program that it started. Arguments: frames, rows and columns of markers on the sail.
// Further benchmarks time the marker-aware adjustment alone, beside COLMAP's program with velamap's
// order of images and outlier rounds.

#include <sys/resource.h>

#include <filesystem>

#include <benchmark/benchmark.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "reconstruct/global/global_registration.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/seed_model.h"
#include "tests/reconstruct/registration_fixture.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

SyntheticScene Sail(int num_frames = 41, int num_rows = 10, int num_columns = 13) {
  SyntheticSceneOptions options;
  options.num_rows = num_rows;
  options.num_columns = num_columns;
  options.spacing_m = 2.6 / num_columns;
  options.marker_length_m = 0.5 * options.spacing_m;
  options.num_frames = num_frames;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.2, 0.05, 0.005, 200, 1}, &scene);
  return scene;
}

SyntheticScene Sail(const benchmark::State& state) {
  return Sail(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
              static_cast<int>(state.range(2)));
}

double CpuSeconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// Cases: frames, rows, columns.
void Sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({41, 10, 13})
      ->Args({82, 10, 13})
      ->Args({164, 10, 13})
      ->Args({41, 5, 13})
      ->Args({41, 20, 13})
      ->Args({41, 4, 5})
      ->Args({41, 20, 25})
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void BM_RegistrationAndAdjustment(benchmark::State& state) {
  const SyntheticScene scene = Sail(state);
  const auto images = DatabaseImages(scene);
  const auto cameras = SceneCameras(scene);
  const double before = CpuSeconds(RUSAGE_SELF);
  for (auto _ : state) {
    Model model =
        MakeSeedModel(RegisterFramesGlobally(images, cameras, scene.layout, {}), images, cameras);
    AdjustWithMarkers({}, scene.layout, CornerErrorsOf(images), &model);
  }
  state.counters["cpu_s"] =
      benchmark::Counter(CpuSeconds(RUSAGE_SELF) - before, benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_RegistrationAndAdjustment)->Apply(Sizes);

Model Seed(const SyntheticScene& scene) {
  Model model = MakeSceneModel(scene);
  PerturbSeed(0.001, 1, &model);  // 4 mm
  return model;
}

void BM_ColmapWithDefaultsInTimeOrder(benchmark::State& state) {
  const Model seed = Seed(Sail(state));
  const TempDir folder;
  const auto input = folder / "seed", output = folder / "adjusted";
  std::filesystem::create_directories(output);
  WriteModel(seed, input.string(), ModelFormat::kBinary);
  const double before = CpuSeconds(RUSAGE_CHILDREN);
  for (auto _ : state) {
    RunColmap("colmap",
              {"bundle_adjuster", "--input_path", input.string(), "--output_path", output.string()},
              (folder / "colmap.log").string());
  }
  state.counters["cpu_s"] =
      benchmark::Counter(CpuSeconds(RUSAGE_CHILDREN) - before, benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_ColmapWithDefaultsInTimeOrder)->Apply(Sizes);

void BM_MarkerAdjustment(benchmark::State& state) {
  const SyntheticScene scene = Sail();
  const Model seed = Seed(scene);
  int num_iterations = 0;
  for (auto _ : state) {
    Model model = seed;
    num_iterations = AdjustWithMarkers({}, scene.layout, {}, &model).num_iterations;
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
