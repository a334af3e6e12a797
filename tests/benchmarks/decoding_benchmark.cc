// CPU time, summed over all threads, of reading the frames of an H.264 video: decoding alone, with
// the grey images that detection needs, and the same through OpenCV's VideoCapture.

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "importer/video/video_decoder.h"
#include "tests/support/clip/clip_writer.h"
#include "tests/support/render/marker_renderer.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

constexpr int kNumFrames = 40;

// A sail of 40 markers with camera noise, at the bit rate of a good camera.
class Clip {
 public:
  explicit Clip(int width_px) {
    const double scale = width_px / 1920.0;
    SyntheticSceneOptions options;
    options.num_columns = 8;
    options.num_frames = kNumFrames;
    options.camera = {CameraModel::kOpenCV,
                      width_px,
                      width_px * 9 / 16,
                      {1200 * scale, 1200 * scale, 960 * scale, 540 * scale, -0.1, 0.03, 0, 0}};
    const SyntheticScene scene = MakeSyntheticScene(options);
    RenderOptions render;
    render.noise_sigma = 2.0;
    render.background_texture = 20.0;
    render.color = true;
    ClipWriterOptions writing;
    writing.bitrate = width_px > 1920 ? "80M" : "20M";
    ClipWriter writer(dir_.path(), writing);
    for (int i = 0; i < kNumFrames; ++i) writer.Write(RenderFrame(scene, i, render));
    writer.Finish();
    path_ = writer.path();
  }

  const std::string& path() const { return path_; }

 private:
  TempDir dir_;
  std::string path_;
};

void SetFramesPerSecond(benchmark::State& state) {
  state.counters["frames/s"] =
      benchmark::Counter(kNumFrames, benchmark::Counter::kIsIterationInvariantRate);
}

// Arguments: width of the frame, whether the grey images are made too.
void BM_DecodeVideo(benchmark::State& state) {
  const Clip clip(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    VideoDecoder decoder(clip.path(), 0);
    while (const std::optional<VideoFrame> frame = decoder.Next()) {
      if (state.range(1) != 0) benchmark::DoNotOptimize(frame->picture.Gray());
    }
  }
  SetFramesPerSecond(state);
}
BENCHMARK(BM_DecodeVideo)
    ->ArgsProduct({{1920, 3840}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

// Argument: width of the frame.
void BM_DecodeVideoWithOpenCv(benchmark::State& state) {
  const Clip clip(static_cast<int>(state.range(0)));
  cv::setNumThreads(1);
  for (auto _ : state) {
    cv::VideoCapture capture(clip.path(), cv::CAP_FFMPEG);
    cv::Mat color, gray;
    while (capture.read(color)) cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  }
  SetFramesPerSecond(state);
}
BENCHMARK(BM_DecodeVideoWithOpenCv)
    ->Arg(1920)
    ->Arg(3840)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace velamap
