#include "importer/video/frame_image.h"

#include <optional>
#include <ostream>
#include <string>

#include "importer/base/atomic_output.h"
#include "importer/video/jpeg_codec.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

constexpr int kJpegQuality = 92;

}  // namespace

void WriteFrameImage(const Frame& frame, const std::filesystem::path& path) {
  const std::optional<ChromaPlanes> chroma =
      frame.picture ? frame.picture->HalfSizeChroma() : std::nullopt;
  const std::string jpeg = chroma ? EncodeJpeg(frame.gray, *chroma, kJpegQuality)
                                  : EncodeJpeg(ColorImage(frame), kJpegQuality);
  WriteFileAtomicallyUnsynced(path, [&](std::ostream& out) { out << WithFrameMark(jpeg); });
}

}  // namespace velamap
