// Makes HEIC files for tests.

#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <libheif/heif.h>
#include <opencv2/core.hpp>

namespace velamap {

// How a phone stores a picture that it held turned.
struct HeicMetadata {
  heif_orientation orientation = heif_orientation_normal;
  std::string exif;  // from "Exif\0\0" on
};

// `gray` is CV_8UC1. Its grey values come back exactly up to rounding.
inline void WriteHeic(const std::string& path, const cv::Mat& gray,
                      const HeicMetadata& metadata = {}) {
  const std::unique_ptr<heif_context, void (*)(heif_context*)> context(heif_context_alloc(),
                                                                       heif_context_free);
  heif_image* image = nullptr;
  heif_image_create(gray.cols, gray.rows, heif_colorspace_monochrome, heif_chroma_monochrome,
                    &image);
  heif_image_add_plane(image, heif_channel_Y, gray.cols, gray.rows, 8);
  int stride = 0;
  std::uint8_t* plane = heif_image_get_plane(image, heif_channel_Y, &stride);
  gray.copyTo(cv::Mat(gray.size(), CV_8UC1, plane, static_cast<std::size_t>(stride)));
  heif_encoder* encoder = nullptr;
  heif_context_get_encoder_for_format(context.get(), heif_compression_HEVC, &encoder);
  heif_encoder_set_lossless(encoder, 1);
  heif_encoding_options* options = heif_encoding_options_alloc();
  options->image_orientation = metadata.orientation;
  heif_image_handle* handle = nullptr;
  const heif_error error =
      heif_context_encode_image(context.get(), image, encoder, options, &handle);
  ASSERT_EQ(error.code, heif_error_Ok) << error.message;
  if (!metadata.exif.empty()) {
    heif_context_add_exif_metadata(context.get(), handle, metadata.exif.data(),
                                   static_cast<int>(metadata.exif.size()));
  }
  heif_context_write_to_file(context.get(), path.c_str());
  heif_image_handle_release(handle);
  heif_encoding_options_free(options);
  heif_encoder_release(encoder);
  heif_image_release(image);
}

}  // namespace velamap
