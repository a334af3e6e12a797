// render_clip: a clip of markers on known surfaces as a camera takes it, with all that velamap is
// told about it and the exact truth. Same options, same bytes of frames, however many threads.

#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <iostream>
#include <vector>

#include <fmt/format.h>

#include "importer/base/statistics.h"
#include "importer/geometry/quad.h"
#include "tests/support/clip/clip_files.h"
#include "tests/support/tool_options.h"
#include "tests/tools/render_clip_options.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Draws frames in parallel, writes them in order.
void RenderAll(const ClipScene& scene, const RenderClipOptions& options, ClipWriter* writer) {
  std::deque<std::future<cv::Mat>> frames;
  int next_frame = 0;
  const int num_frames = scene.options.num_frames;
  while (next_frame < num_frames || !frames.empty()) {
    while (next_frame < num_frames && static_cast<int>(frames.size()) < options.num_threads) {
      frames.push_back(std::async(std::launch::async, [&scene, &options, i = next_frame++] {
        return RenderClipFrame(scene, options.render, i);
      }));
    }
    const cv::Mat frame = frames.front().get();
    frames.pop_front();
    writer->Write(frame);
  }
  writer->Finish();
}

// Over all markers in all frames; 0 where no marker is seen whole.
double MedianSidePx(const ClipScene& scene) {
  std::vector<double> sides_px;
  for (int frame_idx = 0; frame_idx < scene.options.num_frames; ++frame_idx) {
    for (const ClipMarker& marker : scene.markers) {
      const auto corners = ProjectCorners(scene, marker, frame_idx);
      if (corners) sides_px.push_back(QuadMeanSide(*corners));
    }
  }
  return sides_px.empty() ? 0.0 : Median(std::move(sides_px));
}

void Run(int argc, char** argv) {
  const auto read = ReadRenderClipOptions(argc, argv);
  if (!read) return;
  const RenderClipOptions& options = *read;
  cv::setNumThreads(1);  // frames are drawn side by side
  const auto start = std::chrono::steady_clock::now();
  const ClipScene scene = MakeClipScene(options.clip);
  const fs::path folder = options.output_path;
  fs::create_directories(folder);
  WriteClipFiles(scene, folder);
  WriteRenderClipOptions(options, folder / "scene.ini");
  ClipWriter writer(folder, options.writer);
  RenderAll(scene, options, &writer);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::cout << fmt::format(
      "clip: {}\nmarkers: {}\nframes: {}\nsize: {}x{}\nside_px: {:.1f}\n"
      "seconds: {:.1f}\n",
      writer.path().string(), scene.markers.size(), scene.options.num_frames, scene.camera.width_px,
      scene.camera.height_px, MedianSidePx(scene), time.count());
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::RunTool(velamap::Run, argc, argv); }
