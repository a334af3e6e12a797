#include "importer/video/written_frame.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <ostream>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/files.h"
#include "importer/video/jpeg_codec.h"

namespace velamap {
namespace {

constexpr int kJpegQuality = 92;

// The comment's segment (ITU T.81, B.2.4.5): marker, length of what follows, text.
std::string MarkOf(std::uint64_t hash) {
  constexpr int kLengthBytes = 2;
  const std::string text = fmt::format("velamap {:016x}", hash);
  const std::size_t length = text.size() + kLengthBytes;
  return std::string{'\xFF', '\xFE', static_cast<char>(length >> 8), static_cast<char>(length)} +
         text;
}

// The mark follows the start of the image and the segment APP0, which has to be the first.
std::size_t PlaceOfMark(std::string_view jpeg) {
  constexpr std::size_t kStart = 2, kHead = 6;
  if (jpeg.size() < kHead || jpeg.substr(kStart, 2) != "\xFF\xE0") return kStart;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(jpeg[i]); };
  return std::min(jpeg.size(), kStart + 2 + (std::size_t{byte(4)} << 8 | byte(5)));
}

}  // namespace

void WriteFrameImage(const Frame& frame, const std::filesystem::path& path) {
  const std::optional<ChromaPlanes> chroma =
      frame.picture ? frame.picture->HalfSizeChroma() : std::nullopt;
  const std::string jpeg = chroma ? EncodeJpeg(frame.gray, *chroma, kJpegQuality)
                                  : EncodeJpeg(ColorImage(frame), kJpegQuality);
  WriteFileAtomicallyUnsynced(path, [&](std::ostream& out) { out << WithFrameMark(jpeg); });
}

std::string WithFrameMark(std::string_view jpeg) {
  std::string marked(jpeg);
  return marked.insert(PlaceOfMark(jpeg), MarkOf(Hash(jpeg)));
}

bool IsWrittenFrame(const std::filesystem::path& path) {
  if (!IsRegularFile(path)) return false;
  std::ifstream stream(path, std::ios::binary);
  std::string jpeg((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  const std::size_t place = PlaceOfMark(jpeg), size = MarkOf(0).size();
  if (jpeg.size() < place + size) return false;
  const std::string mark = jpeg.substr(place, size);
  return mark == MarkOf(Hash(jpeg.erase(place, size)));
}

}  // namespace velamap
