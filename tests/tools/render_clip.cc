// render_clip: a clip of markers on known surfaces, with all that velamap is told about it and the
// exact truth. Same options, same bytes of frames, however many threads.

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <iostream>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/support/clip_files.h"
#include "tests/support/clip_scene.h"
#include "tests/support/clip_writer.h"
#include "tests/support/surface_renderer.h"

namespace velamap {
namespace {

namespace po = boost::program_options;
namespace fs = std::filesystem;

struct Options {
  std::string output_path;
  std::string scene, format, lens, motion;
  double distance_m = 0.0;  // 0: the scene's own
  int width_px = 0;         // 0: the scene's own
  int num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  ClipOptions clip;
  SurfaceRenderOptions render;
  ClipWriterOptions writer;
};

po::options_description Describe(Options* options) {
  ClipOptions* clip = &options->clip;
  SurfaceRenderOptions* render = &options->render;
  ClipWriterOptions* writer = &options->writer;
  const auto value = [](auto* target) { return po::value(target)->default_value(*target); };
  po::options_description description("render_clip --output_path FOLDER [options]", 100, 60);
  auto add = description.add_options();
  add("help", "this text");
  add("output_path", po::value(&options->output_path)->required(),
      "folder for the clip, made if it is missing");
  add("scene", po::value(&options->scene)->default_value("sail"), "sail, board or walls");
  add("dictionary_bits", value(&clip->dictionary_bits),
      "4: DICT_4X4_250; 3: the thesis's 3x3 bits");
  add("width", value(&options->width_px), "of a frame, px, 16:9; 0: 1920, board 1280");
  add("num_frames", value(&clip->num_frames), "");
  add("fps", value(&clip->fps), "frames a second");
  add("lens", po::value(&options->lens)->default_value(""),
      "wide (109 degrees) or webcam (68); empty: the scene's own");
  add("distance", value(&options->distance_m), "of the camera, m; 0: sail 6, walls 3.5, board 0.6");
  add("angle_deg", value(&clip->angle_deg), "of the view from straight on");
  add("motion", po::value(&options->motion)->default_value("d"),
      "board: a ... h of the thesis's Figure 4.3");
  add("sail_scale", value(&clip->sail_scale), "size of the sail; markers stay 100 mm, fewer fit");
  add("sail_motion_m", value(&clip->sail_motion_m),
      "amplitude of slow flapping about the mean shape");
  add("trim_change_m", value(&clip->trim_change_m),
      "largest displacement of a change of trim halfway; truth_after.csv");
  add("reflection", value(&render->num_reflections), "number of bright patches on the sail");
  add("busy", value(&clip->busy), "clutter behind the scene and on the cloth");
  add("blur_px", value(&render->blur_px), "sigma of the lens's blur, px");
  add("motion_blur_px", value(&render->motion_blur_px),
      "path of the picture during the exposure, px");
  add("noise", value(&render->noise), "standard deviation, grey levels");
  add("format", po::value(&options->format)->default_value("mp4"),
      "mp4 (clip.mp4), png or jpg (images/)");
  add("crf", value(&writer->crf), "constant quality of H.264, 0 (lossless) to 51");
  add("bitrate", value(&writer->bitrate), "instead of crf, as ffmpeg takes it: 30M");
  add("preset", value(&writer->preset), "of x264");
  add("num_threads", value(&options->num_threads), "frames drawn at a time");
  add("seed", value(&clip->seed), "of path, noise and clutter");
  return description;
}

template <typename T>
T Choose(const std::string& option, const std::string& text,
         const std::map<std::string, T>& names) {
  const auto found = names.find(text);
  if (found != names.end()) return found->second;
  std::string known;
  for (const auto& [name, value] : names) known += " " + name;
  throw InputError(fmt::format("--{}: '{}' is unknown; give one of{}", option, text, known));
}

void Complete(Options* options) {
  ClipOptions& clip = options->clip;
  clip.kind = Choose<ClipKind>(
      "scene", options->scene,
      {{"sail", ClipKind::kSail}, {"board", ClipKind::kBoard}, {"walls", ClipKind::kWalls}});
  const bool board = clip.kind == ClipKind::kBoard;
  clip.wide_angle = options->lens.empty()
                        ? !board
                        : Choose<bool>("lens", options->lens, {{"wide", true}, {"webcam", false}});
  clip.width_px = options->width_px != 0 ? options->width_px : board ? 1280 : 1920;
  const double own_distance_m = board ? 0.6 : clip.kind == ClipKind::kWalls ? 3.5 : 6.0;
  clip.distance_m = options->distance_m != 0 ? options->distance_m : own_distance_m;
  if (options->motion.size() != 1) throw InputError("--motion: give one letter, a to h");
  clip.motion = options->motion.front();
  options->writer.format = Choose<ClipFormat>(
      "format", options->format,
      {{"mp4", ClipFormat::kMp4}, {"png", ClipFormat::kPng}, {"jpg", ClipFormat::kJpg}});
  options->writer.fps = clip.fps;
  if (options->num_threads < 1) throw InputError("--num_threads: give 1 or more");
  options->render.Check();
  options->writer.Check();
}

// The options as an ini file that velamap-style tools and people can read.
void WriteOptions(const po::variables_map& values, const fs::path& path) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    for (const auto& [name, value] : values) {
      if (name == "output_path" || name == "num_threads" || name == "help") continue;
      out << name << '=';
      if (const auto* text = boost::any_cast<std::string>(&value.value())) out << *text;
      if (const auto* number = boost::any_cast<int>(&value.value())) out << *number;
      if (const auto* real = boost::any_cast<double>(&value.value())) {
        out << fmt::format("{}", *real);
      }
      if (const auto* flag = boost::any_cast<bool>(&value.value())) out << *flag;
      if (const auto* seed = boost::any_cast<std::uint32_t>(&value.value())) out << *seed;
      out << '\n';
    }
  });
}

// Draws frames in parallel, writes them in order.
void RenderAll(const ClipScene& scene, const Options& options, ClipWriter* writer) {
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

void Run(int argc, char** argv) {
  Options options;
  const po::options_description description = Describe(&options);
  po::variables_map values;
  try {
    po::store(po::parse_command_line(argc, argv, description), values);
    if (values.count("help") > 0) {
      std::cout << description;
      return;
    }
    po::notify(values);
  } catch (const po::error& error) {
    throw InputError(fmt::format("{}; see render_clip --help", error.what()));
  }
  Complete(&options);
  cv::setNumThreads(1);  // frames are drawn side by side
  const auto start = std::chrono::steady_clock::now();
  const ClipScene scene = MakeClipScene(options.clip);
  const fs::path folder = options.output_path;
  fs::create_directories(folder);
  WriteClipFiles(scene, folder);
  WriteOptions(values, folder / "scene.ini");
  ClipWriter writer(folder, options.writer);
  RenderAll(scene, options, &writer);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::cout << fmt::format("clip: {}\nmarkers: {}\nframes: {}\nsize: {}x{}\nseconds: {:.1f}\n",
                           writer.path().string(), scene.markers.size(), scene.options.num_frames,
                           scene.camera.width_px, scene.camera.height_px, time.count());
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) {
  try {
    velamap::Run(argc, argv);
    return 0;
  } catch (const velamap::ExternalToolError& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 3;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
}
