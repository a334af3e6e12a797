#include "importer/video/source_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <set>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/text/output_date.h"

namespace velamap {
namespace {

constexpr std::uint64_t kPartSize = 1 << 16, kNumParts = 16;

// The hash of a large file, from some of its parts.
std::uint64_t HashOfParts(const std::string& path, std::uint64_t size) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> part(kPartSize);
  std::uint64_t hash = Hash("");
  for (std::uint64_t i = 0; i < kNumParts && stream; ++i) {
    stream.seekg(static_cast<std::streamoff>((size - kPartSize) * i / (kNumParts - 1)));
    stream.read(part.data(), static_cast<std::streamsize>(kPartSize));
    hash = Hash({part.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  }
  if (!stream) throw InputError(path + ": cannot be read");
  return hash;
}

std::uint64_t HashOfContent(const std::string& path, std::uint64_t size) {
  const bool is_whole = HasImageExtension(path) || size <= kNumParts * kPartSize;
  return is_whole ? HashOfFile(path) : HashOfParts(path, size);
}

SourceFile SourceWithoutHash(const std::string& path) {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  const std::filesystem::path place = CanonicalPath(path);
  SourceFile source;
  source.name = place.filename().string();
  source.path_hash = Hash(place.string());
  source.size = FileSize(path);
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be read");
  source.modified_s = status.st_mtim.tv_sec;
  source.changed_ns = status.st_ctim.tv_sec * kNsPerS + status.st_ctim.tv_nsec;
  return source;
}

// The first of the names with one of the endings; empty for none.
std::string FirstWithEnding(const std::vector<std::string>& names,
                            const std::set<std::string>& endings) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return endings.count(LowerExtension(name)) > 0;
  });
  return found == names.end() ? "" : *found;
}

}  // namespace

bool HasImageExtension(const std::string& path) {
  static constexpr std::array<const char*, 20> kExtensions = {
      ".jpg", ".jpeg", ".jpe",  ".heic", ".heif", ".hif", ".avif", ".png", ".tif", ".tiff",
      ".bmp", ".dib",  ".webp", ".jp2",  ".pgm",  ".ppm", ".pbm",  ".pnm", ".ras", ".exr"};
  return std::find(kExtensions.begin(), kExtensions.end(), LowerExtension(path)) !=
         kExtensions.end();
}

std::string RemedyForNoImages(const std::filesystem::path& folder,
                              const std::vector<std::string>& names) {
  const std::string raw = FirstWithEnding(
      names, {".dng", ".cr2", ".cr3", ".nef", ".arw", ".raf", ".rw2", ".orf", ".pef", ".gpr"});
  const std::string video =
      FirstWithEnding(names, {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".mts", ".m2ts", ".webm"});
  std::string remedy;
  if (!raw.empty()) {
    remedy += fmt::format(
        "; raw pictures such as {} cannot be read: develop them to JPEG or TIFF, all with the same "
        "settings and without correction of the lens",
        raw);
  }
  if (!video.empty()) {
    remedy += fmt::format("; for a video, give the file itself: {}", (folder / video).string());
  }
  return remedy.empty() ? "; give a folder of images or a video file" : remedy;
}

SourceFile IdentifySource(const std::string& path) {
  SourceFile source = SourceWithoutHash(path);
  source.content_hash = HashOfContent(path, source.size);
  return source;
}

bool HasSameContent(const SourceFile& known, const std::string& path) {
  const SourceFile now = SourceWithoutHash(path);
  if (now.size != known.size) return false;
  if (now.path_hash == known.path_hash && now.changed_ns == known.changed_ns &&
      now.modified_s == known.modified_s) {
    return true;
  }
  return HashOfContent(path, now.size) == known.content_hash;
}

bool IsSamePlace(const SourceFile& known, const std::filesystem::path& path) {
  return Hash(CanonicalPath(path).string()) == known.path_hash;
}

std::string SourceText(const SourceFile& source) {
  const std::tm modified = fmt::gmtime(static_cast<std::time_t>(source.modified_s));
  return fmt::format("{}, {} bytes of {}", source.name, source.size, DateText(modified));
}

}  // namespace velamap
