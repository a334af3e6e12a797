#include "importer/video/frame_source.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/natural_order.h"
#include "importer/base/numbers.h"
#include "importer/base/replacement.h"
#include "importer/video/image_file.h"
#include "importer/video/interlacing.h"
#include "importer/video/video_decoder.h"
#include "importer/video/video_stream.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Keeps OpenCV from printing its own messages about a broken file.
void SilenceOpenCv() {
  static std::once_flag once;
  std::call_once(once,
                 [] { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); });
}

// Logs a message that was not logged before: a video or a folder is read more than once in a run.
void LogOnce(LogLevel level, const std::string& message) {
  static std::mutex mutex;
  static std::set<std::string> logged;
  const std::lock_guard<std::mutex> lock(mutex);
  if (logged.insert(message).second) LogMessage(level, message);
}

// Returns names relative to the folder in natural order, and warns of files that are no images.
std::vector<std::string> ListImages(const fs::path& folder) {
  std::vector<std::string> names, others;
  for (const fs::path& file : FilesBelow(folder)) {
    const std::string name = file.lexically_relative(folder).generic_string();
    (HasImageExtension(name) ? names : others).push_back(name);
  }
  std::sort(names.begin(), names.end(), NaturalLess);
  std::sort(others.begin(), others.end(), NaturalLess);
  if (names.empty()) {
    throw InputError(fmt::format("{}: the folder holds no images (.jpg, .heic, .png, .tif ...){}",
                                 folder.string(), RemedyForNoImages(folder, others)));
  }
  for (const std::string& name : names) CheckImageName(name, folder.string());
  if (!others.empty()) {
    LogOnce(LogLevel::kWarn,
            fmt::format("{}: ignored {} files that have no image extension, such as {}",
                        folder.string(), others.size(), others.front()));
  }
  return names;
}

class ImageFolder : public FrameSource {
 public:
  ImageFolder(fs::path folder, std::vector<std::string> names)
      : folder_(std::move(folder)), names_(std::move(names)) {}

  std::optional<Frame> Next() override {
    if (next_idx_ == names_.size()) return std::nullopt;
    Frame frame;
    frame.image_name = names_[next_idx_++];
    return frame;
  }

  bool Load(Frame* frame, std::string* reason) const override {
    const fs::path path = folder_ / frame->image_name;
    frame->color = DecodeImageFile(path.string(), reason);
    if (frame->color.empty()) {
      LogOnce(LogLevel::kWarn, fmt::format("{}: skipped: {}", path.string(), *reason));
      return false;
    }
    if (!reason->empty()) {
      LogOnce(LogLevel::kWarn,
              fmt::format("{}: used, but {}", path.string(), std::exchange(*reason, "")));
    }
    frame->source = IdentifySource(path.string());
    cv::cvtColor(frame->color, frame->gray, cv::COLOR_BGR2GRAY);
    return true;
  }

  bool IsVideo() const override { return false; }
  int NumFrames() const override { return static_cast<int>(names_.size()); }

 private:
  fs::path folder_;
  std::vector<std::string> names_;
  std::size_t next_idx_ = 0;
};

class VideoFile : public FrameSource {
 public:
  VideoFile(const std::string& path, const VideoOptions& options,
            const std::vector<std::string>& known_names, int num_threads)
      : path_(path),
        options_(options),
        known_names_(known_names.begin(), known_names.end()),
        decoder_(path, num_threads),
        num_container_frames_(decoder_.NumContainerFrames()),
        num_frames_(CountFrames()),
        is_marked_interlaced_(decoder_.IsMarkedInterlaced()) {
    if (decoder_.NumQuarterTurns() != 0) {
      LogOnce(
          LogLevel::kInfo,
          fmt::format("{}: its pictures are turned by {} degrees, as its metadata say; the "
                      "calibration has to come from pictures turned the same way (OpenCV 4.6 turns "
                      "some the other way)",
                      path_, 90 * decoder_.NumQuarterTurns()));
    }
    decoder_.SkipTo(options_.first_frame);
  }

  std::optional<Frame> Next() override {
    const auto begin = std::chrono::steady_clock::now();
    while (!ended_ && (options_.last_frame < 0 || num_read_ <= options_.last_frame)) {
      std::optional<VideoFrame> read = decoder_.Next();
      if (!read) {
        End();
        break;
      }
      num_read_ = read->number + 1;
      if (!options_.Selects(read->number) ||
          known_names_.count(NameOfVideoFrame(read->number)) > 0) {
        continue;
      }
      Frame frame;
      frame.image_name = NameOfVideoFrame(read->number);
      frame.frame_number = read->number;
      frame.time_s = read->time_s;
      frame.picture = std::move(read->picture);
      frame.is_whole = read->is_whole;
      const std::chrono::duration<double> reading = std::chrono::steady_clock::now() - begin;
      frame.reading_s = reading.count();
      return frame;
    }
    return std::nullopt;
  }

  bool Load(Frame* frame, std::string* reason) const override {
    if (!frame->is_whole) {
      *reason = "the file is damaged there";
      return false;
    }
    frame->gray = frame->picture->Gray();
    CheckFields(*frame);
    if (!frame->gray.empty()) return true;
    *reason = "its pixel format cannot be converted to grey";
    LogOnce(LogLevel::kWarn,
            fmt::format("{}: {} is skipped: {}", path_, frame->image_name, *reason));
    return false;
  }

  bool IsVideo() const override { return true; }

  int NumFrames() const override { return num_frames_; }

 private:
  void CheckFields(const Frame& frame) const {
    // The lines of the camera are columns where the picture has been turned on its side.
    const bool is_on_its_side = decoder_.NumQuarterTurns() % 2 != 0;
    const bool is_combed = IsCombed(is_on_its_side ? cv::Mat(frame.gray.t()) : frame.gray);
    const bool is_marked = is_marked_interlaced_ || frame.picture->IsMarkedInterlaced();
    if (!is_combed && is_marked) {
      LogOnce(LogLevel::kInfo, path_ + ": stored as interlaced, but both fields show one moment");
    }
    if (!is_combed) return;
    constexpr char kRemedy[] =
        "make whole pictures of the fields with ffmpeg -i VIDEO -vf bwdif -crf 12 whole.mp4";
    const int num_combed = ++num_combed_;
    if (num_combed < MinCombed()) return;
    if (is_marked) {
      throw InputError(fmt::format(
          "{}: the video is interlaced: {} pictures, such as {}, weave two fields of different "
          "moments; {}",
          path_, num_combed, frame.image_name, kRemedy));
    }
    LogOnce(LogLevel::kWarn,
            fmt::format("{}: pictures seem to weave two fields of different moments, though the "
                        "file does not say that it is interlaced; if they do, {}",
                        path_, kRemedy));
  }

  // Most pictures of an interlaced video with motion are combed. Blinds and similar textures look
  // combed only at a distance at which their period is two lines, to a few percent.
  int MinCombed() const { return std::max(3, num_frames_ / 10); }

  // In 64 bits, because options may be as large as an int.
  int CountFrames() const {
    if (num_container_frames_ == 0 && options_.last_frame < 0) return 0;
    std::int64_t end = num_container_frames_;
    if (options_.last_frame >= 0 && (end == 0 || options_.last_frame < end)) {
      end = std::int64_t{options_.last_frame} + 1;
    }
    const std::int64_t num_frames = end - options_.first_frame;
    if (num_frames <= 0) return 0;
    const std::int64_t num_wanted = (num_frames - 1) / options_.frame_step + 1;
    const std::int64_t num_left = num_wanted - NumKnownBefore(end);
    return static_cast<int>(std::clamp<std::int64_t>(num_left, 0, std::numeric_limits<int>::max()));
  }

  int NumKnownBefore(std::int64_t end) const {
    return static_cast<int>(
        std::count_if(known_names_.begin(), known_names_.end(), [&](const std::string& name) {
          const std::optional<int> number = NumberOfVideoFrame(name);
          return number && *number < end && options_.Selects(*number);
        }));
  }

  void End() {
    ended_ = true;
    if (num_read_ <= options_.first_frame) {
      throw InputError(
          fmt::format("{}: the video has {} frames, none at or after frame {}, the first that is "
                      "wanted",
                      path_, num_read_, options_.first_frame));
    }
    // A container that derives the count from its duration is off by a frame or so.
    const int tolerance = std::max(2, num_container_frames_ / 100);
    if (num_read_ < num_container_frames_ - tolerance) {
      LogOnce(LogLevel::kWarn,
              fmt::format("{}: the video breaks off after {} of {} frames; these are used", path_,
                          num_read_, num_container_frames_));
    }
  }

  std::string path_;
  VideoOptions options_;
  std::set<std::string> known_names_;
  VideoDecoder decoder_;
  int num_container_frames_;
  int num_frames_;  // to come, at most
  bool is_marked_interlaced_;
  mutable std::atomic<int> num_combed_{0};
  int num_read_ = 0;  // counted from the video's start, even if decoding began later
  bool ended_ = false;
};

}  // namespace

cv::Mat ColorImage(const Frame& frame) {
  return frame.picture ? frame.picture->Color() : frame.color;
}

void CheckImagePath(const std::string& path) {
  if (path.empty() || !Exists(path)) {
    throw InputError(
        fmt::format("--image_path '{}': there is no such folder or video; check the path", path));
  }
  if (IsFolder(path)) return;
  if (!IsRegularFile(path)) {
    throw InputError(path + ": a pipe or a device; give a video file, or a folder of images");
  }
  if (FileSize(path) == 0)
    throw InputError(path + ": the file is empty; copy it from the camera again");
  if (HasImageExtension(path)) {
    throw InputError(path +
                     ": a single image, by its name; give the folder that holds the images "
                     "(a video needs the extension of its format, such as .mp4)");
  }
}

double PixelAspect(const std::string& path) {
  return IsFolder(path) ? 1.0 : VideoStream(path).PixelAspect();
}

std::string NameOfVideoFrame(int frame_number) {
  return fmt::format("frame_{:06}.jpg", frame_number);
}

std::optional<int> NumberOfVideoFrame(const std::string& name) {
  const std::size_t begin = name.find('_') + 1, end = name.find('.');
  int number = -1;
  if (end == std::string::npos || begin > end) return std::nullopt;
  const bool is_number =
      ParseNumber(std::string_view(name).substr(begin, end - begin), &number) && number >= 0;
  if (!is_number || NameOfVideoFrame(number) != name) return std::nullopt;
  return number;
}

std::unique_ptr<FrameSource> OpenFrameSource(const std::string& path, const VideoOptions& options,
                                             const std::vector<std::string>& known_names,
                                             int num_threads) {
  options.Check();
  SilenceOpenCv();
  CheckImagePath(path);
  if (!IsFolder(path)) {
    return std::make_unique<VideoFile>(path, options, known_names, num_threads);
  }
  std::vector<std::string> names = ListImages(path);
  const std::set<std::string> known(known_names.begin(), known_names.end());
  names.erase(std::remove_if(names.begin(), names.end(),
                             [&](const std::string& name) { return known.count(name) > 0; }),
              names.end());
  return std::make_unique<ImageFolder>(path, std::move(names));
}

}  // namespace velamap
