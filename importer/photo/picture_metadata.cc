#include "importer/photo/picture_metadata.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <libexif/exif-data.h>

#include "importer/geometry/units.h"
#include "importer/photo/heif_picture.h"

namespace velamap {
namespace {

using ExifPtr = std::unique_ptr<ExifData, void (*)(ExifData*)>;

ExifPtr ReadExif(const std::string& path) {
  // libheif reads nothing from a JPEG file, and libexif nothing from a HEIF file.
  const std::vector<std::uint8_t> heif = ReadHeifExif(path);
  return {heif.empty()
              ? exif_data_new_from_file(path.c_str())
              : exif_data_new_from_data(heif.data(), static_cast<unsigned int>(heif.size())),
          exif_data_unref};
}

// Returns nothing if the tag is missing, is no number, or is not positive.
std::optional<double> PositiveNumber(ExifData* data, ExifIfd directory, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(data->ifd[directory], tag);
  if (entry == nullptr || entry->components < 1 || entry->data == nullptr) return std::nullopt;
  if (entry->size < exif_format_get_size(entry->format)) return std::nullopt;
  const ExifByteOrder order = exif_data_get_byte_order(data);
  double value = 0.0;
  if (entry->format == EXIF_FORMAT_SHORT) {
    value = exif_get_short(entry->data, order);
  } else if (entry->format == EXIF_FORMAT_LONG) {
    value = exif_get_long(entry->data, order);
  } else if (entry->format == EXIF_FORMAT_RATIONAL) {
    const ExifRational rational = exif_get_rational(entry->data, order);
    value = rational.denominator == 0 ? 0.0
                                      : static_cast<double>(rational.numerator) /
                                            static_cast<double>(rational.denominator);
  }
  if (!(value > 0) || !std::isfinite(value)) return std::nullopt;
  return value;
}

int QuarterTurns(double orientation) {
  if (orientation == 3) return 2;
  if (orientation == 6) return 1;
  return orientation == 8 ? 3 : 0;
}

std::optional<double> FocalFromFocalPlane(ExifData* data) {
  constexpr double kMmPerCm = 10.0;
  const auto number = [data](ExifTag tag) { return PositiveNumber(data, EXIF_IFD_EXIF, tag); };
  const auto focal_mm = number(EXIF_TAG_FOCAL_LENGTH);
  const auto per_unit = number(EXIF_TAG_FOCAL_PLANE_X_RESOLUTION);
  const auto width_px = number(EXIF_TAG_PIXEL_X_DIMENSION);
  const auto height_px = number(EXIF_TAG_PIXEL_Y_DIMENSION);
  if (!focal_mm || !per_unit || !width_px || !height_px) return std::nullopt;
  const double unit = number(EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT).value_or(2.0);
  const double mm_per_unit = unit == 3.0 ? kMmPerCm : kMmPerInch;
  return *focal_mm / mm_per_unit * *per_unit / std::hypot(*width_px, *height_px);
}

}  // namespace

PictureMetadata ReadPictureMetadata(const std::string& path) {
  constexpr double kDiagonalOf35mmFilm = 43.2666;  // of 36 mm x 24 mm
  // No real lens is outside; a damaged tag may be.
  constexpr double kMinFocal = 0.1, kMaxFocal = 100.0;
  PictureMetadata metadata;
  const ExifPtr data = ReadExif(path);
  if (!data) return metadata;
  metadata.quarter_turns =
      QuarterTurns(PositiveNumber(data.get(), EXIF_IFD_0, EXIF_TAG_ORIENTATION).value_or(1.0));
  const auto in_35mm =
      PositiveNumber(data.get(), EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  metadata.focal_in_diagonals =
      in_35mm ? *in_35mm / kDiagonalOf35mmFilm : FocalFromFocalPlane(data.get());
  const double focal = metadata.focal_in_diagonals.value_or(1.0);
  if (focal < kMinFocal || focal > kMaxFocal) metadata.focal_in_diagonals.reset();
  return metadata;
}

}  // namespace velamap
