#include "importer/photo/heif_picture.h"

#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/photo/picture_metadata.h"
#include "importer/video/image_file.h"
#include "importer/video/source_file.h"
#include "tests/importer/photo/exif_builder.h"
#include "tests/importer/photo/heif_builder.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

cv::Mat SoftNoise(int width, int height) {
  cv::Mat gray(height, width, CV_8UC1);
  cv::RNG(1).fill(gray, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(gray, gray, {}, 1.0);
  return gray;
}

// Phones store all pictures alike and say how they were held.
TEST(HeifPicture, IsDecodedAsStoredAndItsMetadataSayHowItWasTurned) {
  const TempDir dir;
  const cv::Mat stored = SoftNoise(96, 64);
  ExifBuilder exif;
  exif.SetShort(EXIF_IFD_0, EXIF_TAG_ORIENTATION, 6);
  exif.SetShort(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM, 26);
  WriteHeic(dir / "a.heic", stored, {heif_orientation_rotate_90_cw, exif.Data()});
  EXPECT_TRUE(HasImageExtension(dir / "a.heic"));
  std::string reason;
  cv::Mat gray;
  const cv::Mat image = DecodeImageFile(dir / "a.heic", &reason);
  ASSERT_EQ(image.size(), stored.size()) << reason;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  EXPECT_LE(cv::norm(gray, stored, cv::NORM_INF), 1.0);
  const PictureMetadata metadata = ReadPictureMetadata(dir / "a.heic");
  EXPECT_EQ(metadata.quarter_turns, 1);
  ASSERT_TRUE(metadata.focal_in_diagonals);
  EXPECT_NEAR(*metadata.focal_in_diagonals, 26 / 43.2666, 1e-6);
}

TEST(HeifPicture, WithoutExifSaysNothingOfTheCamera) {
  const TempDir dir;
  WriteHeic(dir / "a.heic", SoftNoise(32, 32));
  const PictureMetadata metadata = ReadPictureMetadata(dir / "a.heic");
  EXPECT_EQ(metadata.quarter_turns, 0);
  EXPECT_FALSE(metadata.focal_in_diagonals);
}

TEST(HeifPicture, ACutOrTooLargeFileGivesAReason) {
  const TempDir dir;
  const std::string path = dir / "a.heic";
  WriteHeic(path, SoftNoise(96, 64));
  std::string reason;
  EXPECT_TRUE(DecodeImageFile(path, &reason, 96 * 64 - 1).empty());
  EXPECT_NE(reason.find("96 x 64 pixels"), std::string::npos) << reason;
  for (const double part : {0.9, 0.5, 0.1, 0.01}) {
    const auto size = static_cast<std::uintmax_t>(part * std::filesystem::file_size(path));
    std::filesystem::resize_file(path, size);
    reason.clear();
    EXPECT_TRUE(DecodeImageFile(path, &reason).empty()) << part;
    EXPECT_FALSE(reason.empty()) << part;
    EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
    EXPECT_FALSE(ReadPictureMetadata(path).focal_in_diagonals);
  }
}

}  // namespace
}  // namespace velamap
