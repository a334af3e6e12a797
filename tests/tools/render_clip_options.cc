#include "tests/tools/render_clip_options.h"

#include <algorithm>
#include <map>
#include <thread>
#include <type_traits>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/camera/calibration.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

template <typename T>
po::typed_value<T>* Value(T* target) {
  if constexpr (std::is_same_v<T, double>) {
    return po::value(target)->default_value(*target, fmt::format("{:.3g}", *target));
  } else {
    return po::value(target)->default_value(*target);
  }
}

// What the camera does to the light that it receives.
void DescribeCamera(RenderClipOptions* options, po::options_description* description) {
  SurfaceRenderOptions* render = &options->render;
  CameraResponse* response = &render->response;
  auto add = description->add_options();
  add("camera", Value(&options->camera),
      "sets the defaults of all others. action: a usual action camera; plain: grey values are "
      "light");
  add("tone_curve", Value(&options->tone_curve),
      "from light to grey values: linear, srgb, gamma, s_curve (sRGB with more contrast)");
  add("gamma", Value(&response->gamma), "of --tone_curve gamma, 1 to 3");
  add("s_curve", Value(&response->s_curve),
      "of --tone_curve s_curve: largest shift of a grey value, part of white, 0 to 0.08");
  add("sharpening", Value(&response->sharpening), "amount of an unsharp mask, 0 to 3");
  add("sharpening_radius_px", Value(&response->sharpening_radius_px), "its sigma, px, 0.3 to 5");
  add("glare", Value(&render->glare), "light scattered over all pixels, part of white, 0 to 0.5");
  add("blur_px", Value(&render->blur_px), "sigma of the lens's blur, px, 0 to 20");
  add("defocus_px", Value(&render->defocus_px),
      "radius of the disc that a point is seen as out of focus, px, 0 to 20");
  add("halo", Value(&render->halo), "share of the light that the lens scatters nearby, 0 to 0.9");
  add("halo_px", Value(&render->halo_px), "sigma of this scatter, px, 1 to 20");
  add("motion_blur_px", Value(&render->motion_blur_px),
      "path of the picture during the exposure, px, 0 to 100");
  add("noise", Value(&render->noise), "standard deviation, of light (white: 255), 0 to 100");
  add("shot_noise", Value(&render->shot_noise),
      "the same at white; grows with the root of light, 0 to 100");
}

void DescribeVideo(RenderClipOptions* options, po::options_description* description) {
  ClipWriterOptions* writer = &options->writer;
  auto add = description->add_options();
  add("format", Value(&options->format), "mp4 (clip.mp4), png or jpg (images/)");
  add("codec", Value(&options->codec), "h264 or h265");
  add("range", Value(&options->range), "of the video's luma: limited (16 to 235) or full");
  add("crf", Value(&writer->crf), "constant quality, 0 (h264: lossless) to 51");
  add("bitrate", Value(&writer->bitrate), "instead of crf, as ffmpeg takes it: 30M");
  add("preset", Value(&writer->preset), "of x264 or x265");
}

po::options_description Describe(RenderClipOptions* options) {
  ClipOptions* clip = &options->clip;
  SurfaceRenderOptions* render = &options->render;
  po::options_description description("render_clip --output_path FOLDER [options]", 100, 60);
  auto add = description.add_options();
  add("help", "this text");
  add("output_path", po::value(&options->output_path)->required(),
      "folder for the clip, made if it is missing");
  add("scene", Value(&options->scene), "sail, board or walls");
  add("dictionary_bits", Value(&clip->dictionary_bits),
      "4, 5: DICT_4X4_250, DICT_5X5_250; 3: the thesis's 3x3 bits");
  add("border_bits", Value(&clip->border_bits), "width of the black border, cells, 1 to 3");
  add("marker_length", Value(&clip->marker_length_m),
      "side of a marker, m; 0: the scene's own, sail and walls 0.1, board 0.04");
  add("width", Value(&options->width_px), "of a frame, px, 16:9; 0: 1920, board 1280");
  add("num_frames", Value(&clip->num_frames), "");
  add("fps", Value(&clip->fps), "frames a second");
  add("lens", Value(&options->lens),
      "wide (109 degrees), webcam (68) or a calibration file of 16:9; empty: the scene's own");
  add("distance", Value(&options->distance_m), "of the camera, m; 0: sail 6, walls 3.5, board 0.6");
  add("angle_deg", Value(&clip->angle_deg), "of the view from straight on");
  add("drift_deg", Value(&clip->drift_deg),
      "by which the camera goes around to either side; 0: sail 18, walls 22");
  add("motion", Value(&options->motion), "board: a ... h of the thesis's Figure 4.3");
  add("sail_scale", Value(&clip->sail_scale),
      "size of the sail; markers keep theirs, so fewer fit");
  add("sail_motion_m", Value(&clip->sail_motion_m),
      "amplitude of slow flapping about the mean shape");
  add("shake_deg", Value(&clip->shake_deg), "amplitude of the camera's fast turns, 0 to 5");
  add("rolling_shutter_s", Value(&clip->rolling_shutter_s),
      "time from the first row of a frame to the last; poses are those of the middle row, s, -0.1 "
      "to 0.1");
  add("trim_change_m", Value(&clip->trim_change_m),
      "largest displacement of a change of trim halfway; truth_after.csv");
  add("reflection", Value(&render->num_reflections), "number of bright patches on the sail");
  add("shadows", Value(&render->num_shadows),
      "number of straight shadows on the sail, of all widths and softness; half of them move, 0 to "
      "100");
  add("shadow_depth", Value(&render->shadow_depth),
      "share of the light that the darkest shadow takes, 0 to 0.95");
  add("busy", Value(&clip->busy), "clutter behind the scene and on the cloth");
  add("margin_sides", Value(&clip->margin_sides),
      "white paper around a marker, part of its side, 0.02 to 0.5");
  add("ink_spread_mm", Value(&clip->ink_spread_mm),
      "dark cells reach that far beyond their outlines, mm, -0.5 to 0.5; the truth is without it");
  add("background_level", Value(&clip->background_level),
      "reflectance of what lies behind the paper, to 1; 0: the scene's own, 0.65 to 0.84");
  add("ink_level", Value(&render->ink_level), "reflectance of dark cells, 0.01 to 0.5");
  add("paper_level", Value(&render->paper_level), "reflectance of the paper, 0.5 to 1");
  DescribeCamera(options, &description);
  DescribeVideo(options, &description);
  add("num_threads", Value(&options->num_threads), "frames drawn at a time");
  add("seed", Value(&clip->seed), "of path, noise and clutter");
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

// A usual action camera before printed markers: sRGB with a little more contrast, a sharpened
// picture, some stray light, noise that grows with the light, narrow margins on darker cloth.
RenderClipOptions ActionCamera() {
  RenderClipOptions options;
  options.camera = "action";
  options.tone_curve = "s_curve";
  SurfaceRenderOptions& render = options.render;
  render.response.sharpening = 0.5;
  render.response.sharpening_radius_px = 1.0;
  render.glare = 0.02;
  render.noise = 0.5;
  render.shot_noise = 3.0;
  render.ink_level = 0.05;
  options.clip.margin_sides = 0.12;
  options.clip.background_level = 0.5;
  return options;
}

// The defaults that --camera chooses, before all other options are read.
RenderClipOptions Defaults(int argc, char** argv) {
  std::string camera = "action";
  po::options_description description;
  description.add_options()("camera", po::value(&camera));
  po::variables_map values;
  try {
    po::store(po::command_line_parser(argc, argv).options(description).allow_unregistered().run(),
              values);
    po::notify(values);
  } catch (const po::error&) {
    return {};  // all options are read once more, and that names the mistake
  }
  return Choose<bool>("camera", camera, {{"plain", false}, {"action", true}}) ? ActionCamera()
                                                                              : RenderClipOptions();
}

// An option that has no effect is a mistake.
void CheckUsed(const po::variables_map& values, const char* option, bool used, const char* remedy) {
  if (used || values[option].defaulted()) return;
  throw InputError(fmt::format("--{}: has no effect here; {}", option, remedy));
}

void CompleteCamera(RenderClipOptions* options) {
  const po::variables_map& values = options->values;
  CameraResponse& response = options->render.response;
  response.tone_curve = Choose<ToneCurveKind>("tone_curve", options->tone_curve,
                                              {{"linear", ToneCurveKind::kLinear},
                                               {"srgb", ToneCurveKind::kSrgb},
                                               {"gamma", ToneCurveKind::kGamma},
                                               {"s_curve", ToneCurveKind::kSCurve}});
  CheckUsed(values, "gamma", response.tone_curve == ToneCurveKind::kGamma,
            "give --tone_curve gamma");
  CheckUsed(values, "s_curve", response.tone_curve == ToneCurveKind::kSCurve,
            "give --tone_curve s_curve");
  CheckUsed(values, "sharpening_radius_px", response.sharpening > 0, "give --sharpening");
  options->writer.codec = Choose<ClipCodec>(
      "codec", options->codec, {{"h264", ClipCodec::kH264}, {"h265", ClipCodec::kH265}});
  options->writer.full_range =
      Choose<bool>("range", options->range, {{"limited", false}, {"full", true}});
}

void Complete(RenderClipOptions* options) {
  CompleteCamera(options);
  ClipOptions& clip = options->clip;
  clip.kind = Choose<ClipKind>(
      "scene", options->scene,
      {{"sail", ClipKind::kSail}, {"board", ClipKind::kBoard}, {"walls", ClipKind::kWalls}});
  const bool board = clip.kind == ClipKind::kBoard;
  if (std::filesystem::is_regular_file(options->lens)) {
    clip.camera = ReadCalibration(options->lens);
  } else {
    clip.wide_angle = options->lens.empty() ? !board
                                            : Choose<bool>("lens", options->lens,
                                                           {{"wide", true}, {"webcam", false}});
  }
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

}  // namespace

std::optional<RenderClipOptions> ReadRenderClipOptions(int argc, char** argv) {
  RenderClipOptions options = Defaults(argc, argv);
  options.num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (!ReadToolOptions(Describe(&options), "render_clip", argc, argv, &options.values)) {
    return std::nullopt;
  }
  Complete(&options);
  return options;
}

void WriteRenderClipOptions(const RenderClipOptions& options, const std::filesystem::path& path) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    for (const auto& [name, value] : options.values) {
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

}  // namespace velamap
