// The options of render_clip.

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <boost/program_options.hpp>

#include "tests/support/clip/clip_scene.h"
#include "tests/support/clip/clip_writer.h"
#include "tests/support/render/surface_renderer.h"

namespace velamap {

struct RenderClipOptions {
  std::string output_path;
  // As they were given; clip, render and writer hold what they mean.
  std::string camera = "plain";
  std::string scene = "sail", format = "mp4", lens, motion = "d";
  std::string tone_curve = "linear", codec = "h264", range = "limited";
  double distance_m = 0.0;  // 0: the scene's own
  int width_px = 0;         // 0: the scene's own
  int num_threads = 0;      // frames drawn at a time
  ClipOptions clip;
  SurfaceRenderOptions render;
  ClipWriterOptions writer;
  boost::program_options::variables_map values;  // of all options, for the record
};

// Nothing after --help, which it prints. Throws InputError that names the option.
std::optional<RenderClipOptions> ReadRenderClipOptions(int argc, char** argv);

// All but folder and threads as an ini file, for people and programs.
void WriteRenderClipOptions(const RenderClipOptions& options, const std::filesystem::path& path);

}  // namespace velamap
