#include "importer/photo/picture_metadata.h"

#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "tests/importer/photo/exif_builder.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

// A JPEG of nothing but EXIF, as far as a reader of EXIF looks.
class ExifFile : public ExifBuilder {
 public:
  std::string Write(std::size_t max_size = 1u << 20) const {
    const std::string jpeg = "\xFF\xD8" + Segment() + "\xFF\xD9";
    const std::string path = (folder_.path() / "picture.jpg").string();
    std::ofstream(path, std::ios::binary) << jpeg.substr(0, max_size);
    return path;
  }

 private:
  TempDir folder_;
};

TEST(PictureMetadata, OrientationsAreQuarterTurns) {
  const std::vector<int> expected = {0, 0, 2, 0, 0, 1, 0, 3};  // of 1 to 8
  for (int orientation = 1; orientation <= 8; ++orientation) {
    ExifFile file;
    file.SetShort(EXIF_IFD_0, EXIF_TAG_ORIENTATION, orientation);
    EXPECT_EQ(ReadPictureMetadata(file.Write()).quarter_turns,
              expected[static_cast<std::size_t>(orientation) - 1])
        << orientation;
  }
}

TEST(PictureMetadata, FocalLengthOf35mmFilmIsByTheDiagonal) {
  ExifFile file;
  file.SetShort(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM, 26);
  const auto focal = ReadPictureMetadata(file.Write()).focal_in_diagonals;
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 26 / 43.2666, 1e-6);
}

TEST(PictureMetadata, FocalLengthByTheFocalPlane) {
  ExifFile file;  // 50 mm on 36 x 24 mm of 6000 x 4000 px
  file.SetRational(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH, 50, 1);
  file.SetRational(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_PLANE_X_RESOLUTION, 60000, 36);
  file.SetShort(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT, 3);
  file.SetLong(EXIF_IFD_EXIF, EXIF_TAG_PIXEL_X_DIMENSION, 6000);
  file.SetLong(EXIF_IFD_EXIF, EXIF_TAG_PIXEL_Y_DIMENSION, 4000);
  const auto focal = ReadPictureMetadata(file.Write()).focal_in_diagonals;
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 50 / 43.2666, 1e-4);
}

TEST(PictureMetadata, DamagedOrMissingExifSaysNothing) {
  ExifFile file;
  file.SetShort(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM, 0);
  EXPECT_FALSE(ReadPictureMetadata(file.Write()).focal_in_diagonals);
  for (const std::size_t size : {0u, 3u, 12u, 20u, 30u}) {
    const PictureMetadata metadata = ReadPictureMetadata(file.Write(size));
    EXPECT_FALSE(metadata.focal_in_diagonals) << size;
    EXPECT_EQ(metadata.quarter_turns, 0) << size;
  }
  EXPECT_EQ(ReadPictureMetadata("/no/such/file.jpg").quarter_turns, 0);
}

}  // namespace
}  // namespace velamap
