#include "tests/bad_input/sandbox.h"

#include <sstream>
#include <stdexcept>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "importer/base/files.h"
#include "tests/support/render/marker_renderer.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {
namespace {

constexpr int kWidth = 320, kHeight = 240, kNumImages = 4;

void WriteCamera(const fs::path& path, double focal_px) {
  WriteTextFile(path, fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
                                  "camera_matrix: [{f}, 0., {}, 0., {f}, {}, 0., 0., 1.]\n"
                                  "distortion_coefficients: [0., 0., 0., 0., 0.]\n",
                                  kWidth, kHeight, kWidth / 2 - 0.5, kHeight / 2 - 0.5,
                                  fmt::arg("f", focal_px)));
}

void WriteLayout(const Layout& layout, const fs::path& path) {
  WriteTextFile(path, fmt::format("dictionary: {}\nmarker_length: {}\nparts:\n  board: {{markers: "
                                  "[{}]}}\n",
                                  layout.dictionary, layout.marker_length_m,
                                  fmt::join(MarkerIds(layout), ", ")));
}

SyntheticScene MakeScene(int num_frames, bool is_video) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kPlane;
  options.num_rows = 2;
  options.num_columns = 3;
  options.num_frames = num_frames;
  options.video = is_video;
  options.camera = {
      CameraModel::kPinhole, kWidth, kHeight, {300.0, 300.0, kWidth / 2.0, kHeight / 2.0}};
  return MakeSyntheticScene(options);
}

}  // namespace

void WriteLongClip(int num_frames, const fs::path& path) {
  const SyntheticScene scene = MakeScene(num_frames, true);
  cv::VideoWriter video(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0,
                        {kWidth, kHeight});
  RenderOptions render;
  render.supersampling = 1;
  render.color = true;
  for (int i = 0; i < num_frames; ++i) video << RenderFrame(scene, i, render);
}

void MakeSandbox(const fs::path& dir) {
  const SyntheticScene scene = MakeScene(kNumImages, false);
  fs::create_directories(dir / "images");
  fs::create_directories(dir / "grey");
  cv::VideoWriter video(dir / "clip.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                        {kWidth, kHeight});
  RenderOptions render;
  render.supersampling = 2;
  render.color = true;
  for (int i = 0; i < kNumImages; ++i) {
    const cv::Mat picture = RenderFrame(scene, i, render);
    cv::imwrite(dir / "images" / fmt::format("{}.png", i + 1), picture);
    video << picture;
  }
  for (const char* name : {"a.png", "b.png"}) {
    cv::imwrite(dir / "grey" / name, cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(128)));
  }
  WriteCamera(dir / "camera.yml", 300.0);
  WriteLayout(scene.layout, dir / "layout.yml");
  const ProgramRun run = RunVelamap(ArgumentsIn(dir, kRerun));
  if (run.exit_code != 0) throw std::runtime_error("the sandbox cannot be made: " + run.err);
}

std::vector<std::string> ArgumentsIn(const fs::path& dir, const std::string& command) {
  std::vector<std::string> arguments;
  std::istringstream words(command);
  for (std::string word; words >> word;) {
    for (std::size_t i = word.find('@'); i != std::string::npos; i = word.find('@')) {
      word.replace(i, 1, dir.string());
    }
    arguments.push_back(word);
  }
  return arguments;
}

std::map<std::string, std::string> ContentOf(const fs::path& dir) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir)) {
    std::string& text = content[entry.path().lexically_relative(dir).string()];
    if (entry.is_symlink()) {
      text = "-> " + fs::read_symlink(entry.path()).string();
    } else if (entry.is_regular_file()) {
      text = fmt::format("{:016x}", HashOfFile(entry.path()));
    }
  }
  return content;
}

std::function<void(const fs::path&)> Write(const std::string& name, const std::string& text) {
  return [=](const fs::path& dir) { WriteTextFile(dir / name, text); };
}

void Replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = ReadFileBytes(file);
  const std::size_t i = text.find(from);
  if (i == std::string::npos) throw std::runtime_error(file.string() + " has no " + from);
  fs::remove(file);
  WriteTextFile(file, text.replace(i, from.size(), to));
}

void RunSql(const fs::path& database, const std::string& sql) {
  SQLite::Database(database.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec(sql);
}

}  // namespace velamap
