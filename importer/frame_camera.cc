#include "importer/frame_camera.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/camera/calibration.h"
#include "importer/camera/turned_camera.h"
#include "importer/photo/picture_metadata.h"

namespace velamap {
namespace {

PictureMetadata MetadataOf(const MarkerImporterOptions& options, bool is_video,
                           const Frame& frame) {
  if (is_video) return {};
  return ReadPictureMetadata(
      (std::filesystem::path(options.image_path) / frame.image_name).string());
}

}  // namespace

Camera CameraOfFrame(const MarkerImporterOptions& options, bool is_video, const Frame& frame) {
  const int width_px = frame.gray.cols, height_px = frame.gray.rows;
  if (!options.camera) {
    const PictureMetadata metadata = MetadataOf(options, is_video, frame);
    return UnknownCamera(width_px, height_px,
                         metadata.focal_in_diagonals
                             ? *metadata.focal_in_diagonals * std::hypot(width_px, height_px)
                             : 0.0);
  }
  Camera camera = *options.camera;
  if (IsTransposedSize(camera, width_px, height_px)) {
    // The calibration is for upright pictures, but the pixels are used as stored in the file.
    camera = TurnCamera(camera, -MetadataOf(options, is_video, frame).quarter_turns);
  }
  try {
    return ScaleToImageSize(camera, width_px, height_px, options.camera_path);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} (image {})", error.what(), frame.image_name));
  }
}

bool IsSameCalibration(const MarkerImporterOptions& options, const Camera& camera) {
  if (!options.camera) return false;
  if (!IsTransposedSize(*options.camera, camera.width_px, camera.height_px)) {
    return ScaleToImageSize(*options.camera, camera.width_px, camera.height_px,
                            options.camera_path) == camera;
  }
  for (const int quarter_turns : {1, 3}) {
    const Camera turned = TurnCamera(*options.camera, quarter_turns);
    if (ScaleToImageSize(turned, camera.width_px, camera.height_px, options.camera_path) ==
        camera) {
      return true;
    }
  }
  return false;
}

}  // namespace velamap
