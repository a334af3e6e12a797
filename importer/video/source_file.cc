#include "importer/video/source_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

constexpr std::uint64_t kPartSize = 1 << 16, kNumParts = 16;

std::uint64_t HashOfParts(const std::string& path, std::uint64_t size) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> part(kPartSize);
  std::uint64_t hash = Hash("");
  const std::uint64_t last = size > kPartSize ? size - kPartSize : 0;
  for (std::uint64_t i = 0; i < kNumParts && stream; ++i) {
    // Small files are read as a whole, without overlap.
    const std::uint64_t begin =
        size <= kNumParts * kPartSize ? i * kPartSize : last / (kNumParts - 1) * i;
    if (begin >= size) break;
    stream.seekg(static_cast<std::streamoff>(begin));
    stream.read(part.data(), static_cast<std::streamsize>(std::min(kPartSize, size - begin)));
    hash = Hash({part.data(), static_cast<std::size_t>(stream.gcount())}, hash);
  }
  if (!stream) throw InputError(path + ": cannot be read");
  return hash;
}

}  // namespace

bool HasImageExtension(const std::string& path) {
  static constexpr std::array<const char*, 16> kExtensions = {
      ".jpg",  ".jpeg", ".jpe", ".png", ".tif", ".tiff", ".bmp", ".dib",
      ".webp", ".jp2",  ".pgm", ".ppm", ".pbm", ".pnm",  ".ras", ".exr"};
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

SourceFile IdentifySource(const std::string& path) {
  SourceFile source;
  source.path = CanonicalPath(path).string();
  source.size = FileSize(path);
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) source.modified_s = status.st_mtim.tv_sec;
  source.parts_hash = HashOfParts(path, source.size);
  return source;
}

bool HaveSameContent(const SourceFile& one, const SourceFile& other) {
  return one.size == other.size && one.parts_hash == other.parts_hash;
}

std::string SourceText(const SourceFile& source) {
  return fmt::format("{}, {} bytes of {:%Y-%m-%d %H:%M} UTC", source.path, source.size,
                     fmt::gmtime(static_cast<std::time_t>(source.modified_s)));
}

}  // namespace velamap
