#include "importer/photo/heif_picture.h"

#include <algorithm>
#include <memory>
#include <new>

#include <libheif/heif.h>
#include <opencv2/imgproc.hpp>

namespace velamap {
namespace {

struct HeifFreer {
  void operator()(heif_context* context) const { heif_context_free(context); }
  void operator()(heif_decoding_options* options) const { heif_decoding_options_free(options); }
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
};

template <typename T>
using HeifPtr = std::unique_ptr<T, HeifFreer>;

// The main picture of a file and what it refers to.
struct PrimaryPicture {
  HeifPtr<heif_context> context;
  HeifPtr<heif_image_handle> handle;  // null if the file is damaged
  std::string damage;
};

// Some of libheif's messages end with a line feed.
std::string DamageText(const heif_error& error) {
  std::string text = error.message;
  text.erase(text.find_last_not_of(" \n") + 1);
  return text;
}

template <typename Reader>
PrimaryPicture OpenPrimary(const Reader& read) {
  PrimaryPicture primary{HeifPtr<heif_context>(heif_context_alloc()), nullptr, ""};
  if (primary.context == nullptr) throw std::bad_alloc();
  heif_error error = read(primary.context.get());
  heif_image_handle* handle = nullptr;
  if (error.code == heif_error_Ok) {
    error = heif_context_get_primary_image_handle(primary.context.get(), &handle);
  }
  primary.handle.reset(handle);
  if (error.code != heif_error_Ok) primary.damage = DamageText(error);
  return primary;
}

// `bytes` have to outlive the result.
PrimaryPicture OpenPrimary(const std::vector<std::uint8_t>& bytes) {
  return OpenPrimary([&](heif_context* context) {
    return heif_context_read_from_memory_without_copy(context, bytes.data(), bytes.size(), nullptr);
  });
}

}  // namespace

bool IsHeif(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kMaxHead = 64;  // holds the brands that cameras write
  const auto size = static_cast<int>(std::min(bytes.size(), kMaxHead));
  return heif_check_filetype(bytes.data(), size) == heif_filetype_yes_supported;
}

std::optional<cv::Size> HeifSize(const std::vector<std::uint8_t>& bytes) {
  const PrimaryPicture primary = OpenPrimary(bytes);
  if (primary.handle == nullptr) return std::nullopt;
  return cv::Size(heif_image_handle_get_width(primary.handle.get()),
                  heif_image_handle_get_height(primary.handle.get()));
}

cv::Mat DecodeHeif(const std::vector<std::uint8_t>& bytes, std::string* damage) {
  const PrimaryPicture primary = OpenPrimary(bytes);
  *damage = primary.damage;
  if (primary.handle == nullptr) return {};
  const HeifPtr<heif_decoding_options> options(heif_decoding_options_alloc());
  if (options == nullptr) throw std::bad_alloc();
  options->ignore_transformations = 1;
  heif_image* decoded = nullptr;
  const heif_error error = heif_decode_image(primary.handle.get(), &decoded, heif_colorspace_RGB,
                                             heif_chroma_interleaved_RGB, options.get());
  const HeifPtr<heif_image> image(decoded);
  if (error.code != heif_error_Ok) {
    *damage = DamageText(error);
    return {};
  }
  int stride = 0;
  const std::uint8_t* pixels =
      heif_image_get_plane_readonly(decoded, heif_channel_interleaved, &stride);
  if (pixels == nullptr) return {};
  const cv::Mat rgb(heif_image_get_height(decoded, heif_channel_interleaved),
                    heif_image_get_width(decoded, heif_channel_interleaved), CV_8UC3,
                    const_cast<std::uint8_t*>(pixels), static_cast<std::size_t>(stride));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

std::vector<std::uint8_t> ReadHeifExif(const std::string& path) {
  constexpr std::uint8_t kExif[] = {'E', 'x', 'i', 'f', 0, 0};
  constexpr std::size_t kOffsetBytes = 4;  // the place of the TIFF header, big-endian
  const PrimaryPicture primary = OpenPrimary([&](heif_context* context) {
    return heif_context_read_from_file(context, path.c_str(), nullptr);
  });
  heif_item_id item = 0;
  if (primary.handle == nullptr || heif_image_handle_get_list_of_metadata_block_IDs(
                                       primary.handle.get(), "Exif", &item, 1) != 1) {
    return {};
  }
  std::vector<std::uint8_t> block(heif_image_handle_get_metadata_size(primary.handle.get(), item));
  if (block.size() < kOffsetBytes ||
      heif_image_handle_get_metadata(primary.handle.get(), item, block.data()).code !=
          heif_error_Ok) {
    return {};
  }
  const std::size_t place = std::size_t{block[0]} << 24 | std::size_t{block[1]} << 16 |
                            std::size_t{block[2]} << 8 | block[3];
  if (place > block.size() - kOffsetBytes) return {};
  std::vector<std::uint8_t> exif(std::begin(kExif), std::end(kExif));
  exif.insert(exif.end(), block.begin() + static_cast<std::ptrdiff_t>(kOffsetBytes + place),
              block.end());
  return exif;
}

}  // namespace velamap
