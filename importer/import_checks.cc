#include "importer/import_checks.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/camera/calibration.h"

namespace velamap {
namespace {

// Another dictionary or polarity has to find this many times as many markers a frame to be
// suggested.
constexpr double kConvincingRatio = 10.0;

}  // namespace

void CheckExisting(const MarkerImporterOptions& options, const std::string& detector,
                   const ColmapDatabase& database) {
  const std::string remedy = "delete it, or write to a new place";
  const std::optional<std::string> known_detector = database.ReadDetector();
  if (!known_detector) return;  // it holds no images
  if (*known_detector != detector) {
    throw InputError(
        fmt::format("{}: was made with other detection options, another layout or "
                    "another prior shape ({}; this run has {}); {}",
                    options.database_path, *known_detector, detector, remedy));
  }
  for (const auto& [camera_id, camera] : database.ReadCameras()) {
    const Camera expected =
        ScaleToImageSize(options.camera, camera.width_px, camera.height_px, options.camera_path);
    if (!(expected == camera)) {
      throw InputError(fmt::format("{}: was made with another calibration than {}; {}",
                                   options.database_path, options.camera_path, remedy));
    }
  }
}

void CheckMarkersFound(const MarkerImporterOptions& options, const std::string& dictionary_name,
                       const ImageSample& sample, const ImportReport& report) {
  const std::vector<DictionaryHint> hints =
      SuggestDictionaries(sample.Images(), options.layout.border_bits, options.detection);
  const double rate = static_cast<double>(report.num_markers + report.num_rejected) /
                      std::max(report.num_frames_read, 1);
  const bool is_convincing =
      !hints.empty() && static_cast<double>(hints.front().num_markers) >=
                            kConvincingRatio * rate * hints.front().num_images;
  if (is_convincing) {
    throw DataError(fmt::format("{}: {} marker of {}{} found in {} frames; found with {}",
                                options.image_path,
                                report.num_markers + report.num_rejected > 0 ? "hardly any" : "no",
                                dictionary_name, options.detection.inverted ? " (inverted)" : "",
                                report.num_frames_read, DescribeHints(hints)));
  }
  if (report.num_markers > 0) return;
  if (!report.ids_not_in_layout.empty()) {
    throw DataError(
        fmt::format("{}: no marker of the layout found, only other ids: {}; check the "
                    "layout's dictionary and markers",
                    options.image_path, fmt::join(report.ids_not_in_layout, " ")));
  }
  if (report.num_rejected > 0) {
    throw DataError(
        fmt::format("{}: every marker id is there more than once; give a layout "
                    "(--layout_path) that tells the markers apart",
                    options.image_path));
  }
  throw DataError(fmt::format(
      "{}: no marker of {}{} found in {} frames; no predefined dictionary finds any: check focus, "
      "size and border of the markers",
      options.image_path, dictionary_name, options.detection.inverted ? " (inverted)" : "",
      report.num_frames_read));
}

}  // namespace velamap
