#include "tests/support/clip/clip_writer.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "importer/base/error.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

[[noreturn]] void ThrowFfmpegFailure(const std::filesystem::path& path) {
  throw ExternalToolError(
      fmt::format("ffmpeg: failed to write {}; is ffmpeg installed, with libx264 and libx265, and "
                  "the disk not full?",
                  path.string()));
}

}  // namespace

void ClipWriterOptions::Check() const { CheckOptionRange("crf", crf, 0, 51); }

ClipWriter::ClipWriter(const std::filesystem::path& folder, const ClipWriterOptions& options)
    : options_(options),
      path_(folder / (options.format == ClipFormat::kMp4 ? "clip.mp4" : "images")) {
  options.Check();
  if (options.format != ClipFormat::kMp4) std::filesystem::create_directories(path_);
}

ClipWriter::~ClipWriter() {
  if (pipe_ != nullptr) std::fclose(pipe_);
  if (child_pid_ > 0) waitpid(child_pid_, nullptr, 0);
}

std::vector<std::string> ClipWriter::FfmpegArguments(const cv::Size& size) const {
  std::vector<std::string> arguments = {"ffmpeg",    "-y",
                                        "-loglevel", "error",
                                        "-f",        "rawvideo",
                                        "-pix_fmt",  "bgr24",
                                        "-s",        fmt::format("{}x{}", size.width, size.height),
                                        "-r",        fmt::format("{}", options_.fps),
                                        "-i",        "-",
                                        "-threads",  "1"};
  const auto add = [&](const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  if (options_.codec == ClipCodec::kH264) {
    add({"-c:v", "libx264"});
  } else {
    // hvc1 as cameras write it; one thread and no list of settings in the stream, for the same
    // bytes.
    add({"-c:v", "libx265", "-tag:v", "hvc1", "-x265-params",
         "log-level=error:pools=none:frame-threads=1:info=0"});
  }
  add({"-preset", options_.preset, "-pix_fmt", "yuv420p"});
  if (options_.full_range) add({"-vf", "scale=out_range=full", "-color_range", "pc"});
  // No date and no program version in the file: same frames, same bytes.
  add({"-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"});
  if (options_.bitrate.empty()) {
    add({"-crf", fmt::format("{}", options_.crf)});
  } else {
    add({"-b:v", options_.bitrate});
  }
  add({path_.string()});
  return arguments;
}

void ClipWriter::StartFfmpeg(const cv::Size& size) {
  std::vector<std::string> arguments = FfmpegArguments(size);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  // An ffmpeg that ends early shows as a failed write, not as a signal.
  signal(SIGPIPE, SIG_IGN);
  child_pid_ = fork();
  if (child_pid_ < 0) throw std::runtime_error("fork failed");
  if (child_pid_ == 0) {
    dup2(ends[0], STDIN_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(ends[0]);
  pipe_ = fdopen(ends[1], "wb");
}

void ClipWriter::Write(const cv::Mat& frame) {
  const int frame_idx = num_frames_++;
  if (options_.format != ClipFormat::kMp4) {
    const char* extension = options_.format == ClipFormat::kPng ? "png" : "jpg";
    const auto file = path_ / fmt::format("frame_{:06}.{}", frame_idx, extension);
    if (!cv::imwrite(file.string(), frame)) {
      throw InputError(fmt::format("{}: cannot be written", file.string()));
    }
    return;
  }
  if (pipe_ == nullptr) StartFfmpeg(frame.size());
  if (std::fwrite(frame.data, frame.elemSize(), frame.total(), pipe_) != frame.total()) {
    Finish();
    ThrowFfmpegFailure(path_);
  }
}

void ClipWriter::Finish() {
  if (pipe_ == nullptr) return;
  const bool flushed = std::fclose(pipe_) == 0;
  pipe_ = nullptr;
  int status = 0;
  waitpid(child_pid_, &status, 0);
  child_pid_ = -1;
  if (!flushed || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    ThrowFfmpegFailure(path_);
  }
}

}  // namespace velamap
