#include "importer/video/image_file.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

cv::Mat PictureOfNoise(int width, int height, int type = CV_8UC3) {
  cv::Mat image(height, width, type);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_8U ? 256 : 65536);
  return image;
}

void ShortenFile(const fs::path& path, double fraction) {
  fs::resize_file(path, static_cast<std::uintmax_t>(fraction * fs::file_size(path)));
}

struct PictureFormat {
  const char* name;
  int type;
  std::vector<int> parameters;  // of cv::imwrite
};

// OpenCV's codecs are other code than velamap's.
TEST(DecodeImageFile, ReadsWhatOpenCvReads) {
  const TempDir dir;
  const std::vector<PictureFormat> formats = {
      {"a.jpg", CV_8UC3, {}},
      {"a.jpg", CV_8UC1, {}},
      {"a.jpg", CV_8UC3, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_QUALITY, 60}},
      {"a.png", CV_8UC3, {}},
      {"a.png", CV_8UC1, {}},
      {"a.png", CV_8UC4, {}},
      {"a.png", CV_16UC1, {}},
      {"a.png", CV_16UC3, {}},
      {"a.tif", CV_8UC3, {}},
      {"a.tif", CV_8UC1, {}},
      {"a.tif", CV_16UC3, {}},
      {"a.tif", CV_8UC3, {cv::IMWRITE_TIFF_COMPRESSION, 1}},
      {"a.tif", CV_8UC3, {cv::IMWRITE_TIFF_COMPRESSION, 8}},
      {"a.tif", CV_8UC3, {cv::IMWRITE_TIFF_COMPRESSION, 32773}},
      {"a.bmp", CV_8UC3, {}},
      {"a.bmp", CV_8UC1, {}},
      {"a.webp", CV_8UC3, {cv::IMWRITE_WEBP_QUALITY, 101}},
      {"a.jp2", CV_8UC3, {cv::IMWRITE_JPEG2000_COMPRESSION_X1000, 1000}},
      {"a.ppm", CV_8UC3, {}},
      {"a.pgm", CV_8UC1, {}},
      {"a.pgm", CV_8UC1, {cv::IMWRITE_PXM_BINARY, 0}},
      {"a.pbm", CV_8UC1, {}},
      {"a.ras", CV_8UC3, {}},
  };
  for (const PictureFormat& format : formats) {
    const std::string path = dir / format.name;
    cv::imwrite(path, PictureOfNoise(83, 61, format.type), format.parameters);
    const cv::Mat expected = cv::imread(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    std::string reason;
    const cv::Mat image = DecodeImageFile(path, &reason);
    ASSERT_EQ(image.size(), expected.size()) << format.name << ": " << reason;
    ASSERT_EQ(image.type(), CV_8UC3) << format.name;
    // 16 bits are rounded by one and cut by the other.
    const double max_difference = CV_MAT_DEPTH(format.type) == CV_8U ? 0.0 : 1.0;
    EXPECT_LE(cv::norm(image, expected, cv::NORM_INF), max_difference)
        << format.name << " of type " << format.type;
  }
}

TEST(DecodeImageFile, HeaderOfAPgmMayBeOneLine) {
  const TempDir dir;
  std::string reason;
  std::ofstream(dir / "a.pgm") << "P5 3 2 255\n"
                               << "abcdef";
  const cv::Mat image = DecodeImageFile(dir / "a.pgm", &reason);
  ASSERT_EQ(image.size(), cv::Size(3, 2)) << reason;
  EXPECT_EQ(image.at<cv::Vec3b>(1, 2), cv::Vec3b('f', 'f', 'f'));
}

TEST(DecodeImageFile, TellsWholeFromBrokenFiles) {
  const TempDir dir;
  for (const char* name : {"a.jpg", "a.png", "a.tif", "a.bmp"}) {
    const std::string path = dir / name;
    cv::imwrite(path, PictureOfNoise(80, 60));
    std::string reason;
    EXPECT_EQ(DecodeImageFile(path, &reason).size(), cv::Size(80, 60)) << name << ": " << reason;
  }
  for (const char* name : {"a.jpg", "a.png"}) {
    for (const double fraction : {0.99, 0.5, 0.1}) {
      const std::string path = dir / name;
      cv::imwrite(path, PictureOfNoise(80, 60));
      ShortenFile(path, fraction);
      std::string reason;
      EXPECT_TRUE(DecodeImageFile(path, &reason).empty());
      EXPECT_EQ(reason, "the file is cut off") << name << " " << fraction;
    }
  }
}

TEST(DecodeImageFile, AcceptsDataBehindTheEndOfAJpeg) {
  const TempDir dir;
  const std::string path = dir / "a.jpg";
  cv::imwrite(path, PictureOfNoise(80, 60));
  std::ofstream(path, std::ios::app) << "what phones append";
  std::string reason;
  EXPECT_FALSE(DecodeImageFile(path, &reason).empty()) << reason;
}

void WriteBytes(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

// A decoder resynchronizes with right pixels in the wrong place.
TEST(DecodeImageFile, AJpegWithADamagedMiddleIsNotUsedWithoutAWord) {
  const TempDir dir;
  cv::RNG random(3);
  for (const std::vector<int>& parameters : {std::vector<int>{},
                                             {cv::IMWRITE_JPEG_PROGRESSIVE, 1},
                                             {cv::IMWRITE_JPEG_RST_INTERVAL, 7}}) {
    std::vector<std::uint8_t> whole;
    cv::imencode(".jpg", PictureOfNoise(160, 120), whole, parameters);
    std::size_t begin = whole.size() / 2;
    while (whole[begin - 1] == 0xFF) ++begin;
    int num_noticed = 0;
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes = whole;
      for (std::size_t at = begin; at < begin + 40; ++at) {
        bytes[at] = static_cast<std::uint8_t>(random.uniform(0, 0xFF));  // no markers
      }
      WriteBytes(dir / "a.jpg", bytes);
      std::string reason;
      const cv::Mat image = DecodeImageFile(dir / "a.jpg", &reason);
      num_noticed += image.empty() || reason.rfind("may be damaged (", 0) == 0;
      EXPECT_EQ(image.empty(), reason.rfind("the file is damaged (", 0) == 0) << reason;
    }
    EXPECT_GE(num_noticed, 18) << parameters.size();
  }
}

TEST(DecodeImageFile, ACompressedTiffWithADamagedMiddleIsNotUsed) {
  const TempDir dir;
  cv::RNG random(4);
  for (const int compression : {5, 8}) {  // LZW, Deflate
    std::vector<std::uint8_t> whole;
    cv::imencode(".tif", PictureOfNoise(160, 120), whole,
                 {cv::IMWRITE_TIFF_COMPRESSION, compression});
    int num_noticed = 0;
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes = whole;
      const std::size_t begin = whole.size() * (20 + i) / 60;
      for (std::size_t at = begin; at < begin + 400; ++at) {
        bytes[at] = static_cast<std::uint8_t>(random.uniform(0, 256));
      }
      WriteBytes(dir / "a.tif", bytes);
      std::string reason;
      num_noticed += DecodeImageFile(dir / "a.tif", &reason).empty();
    }
    EXPECT_GE(num_noticed, 18) << compression;
  }
}

TEST(DecodeImageFile, PaddingBeforeTheEndOfAJpegIsNoDamage) {
  const TempDir dir;
  std::vector<std::uint8_t> whole;
  cv::imencode(".jpg", PictureOfNoise(80, 60), whole);
  std::string reason;
  const auto decode = [&](const std::vector<std::uint8_t>& inserted) {
    std::vector<std::uint8_t> bytes = whole;
    bytes.insert(bytes.end() - 2, inserted.begin(), inserted.end());
    bytes.insert(bytes.end(), {'m', 'o', 'r', 'e'});
    WriteBytes(dir / "a.jpg", bytes);
    reason.clear();
    return DecodeImageFile(dir / "a.jpg", &reason);
  };
  const cv::Mat image = decode({});
  ASSERT_FALSE(image.empty());
  for (const std::vector<std::uint8_t>& padding :
       {std::vector<std::uint8_t>(32, 0), {0xFF, 0, 0xFF, 0, 0xFF, 0}}) {
    const cv::Mat padded = decode(padding);
    ASSERT_EQ(padded.size(), image.size());
    EXPECT_EQ(cv::norm(padded, image, cv::NORM_INF), 0.0);
    EXPECT_EQ(reason, "");
  }
  // Compressed data may come from a camera or from damage.
  EXPECT_FALSE(decode({whole.end() - 30, whole.end() - 2}).empty());
  EXPECT_EQ(reason.rfind("may be damaged (", 0), 0u) << reason;
}

TEST(DecodeImageFile, IsNotFooledByThePreviewOfACutJpeg) {
  // A preview in an APP1 segment has an end-of-image marker of its own.
  const TempDir dir;
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", PictureOfNoise(80, 60), jpeg);
  std::vector<std::uint8_t> bytes = {0xFF, 0xD8, 0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD8, 0xFF, 0xD9};
  bytes.insert(bytes.end(), jpeg.begin() + 2, jpeg.end());
  std::string reason;
  WriteBytes(dir / "a.jpg", bytes);
  EXPECT_FALSE(DecodeImageFile(dir / "a.jpg", &reason).empty()) << reason;
  ShortenFile(dir / "a.jpg", 0.5);
  EXPECT_TRUE(DecodeImageFile(dir / "a.jpg", &reason).empty());
}

TEST(DecodeImageFile, RefusesWhatIsTooLarge) {
  const TempDir dir;
  std::string reason;
  cv::imwrite(dir / "a.png", cv::Mat(60, 80, CV_8UC1, cv::Scalar(9)));
  EXPECT_FALSE(DecodeImageFile(dir / "a.png", &reason, 4800).empty());
  EXPECT_TRUE(DecodeImageFile(dir / "a.png", &reason, 4799).empty());
  EXPECT_EQ(reason, "has 80 x 60 pixels, more than the limit of 4799 pixels");
  std::filesystem::resize_file(dir / "a.png", kMaxImageFileSize + 1);
  EXPECT_TRUE(DecodeImageFile(dir / "a.png", &reason).empty());
  EXPECT_EQ(reason, "has 1073741825 bytes, more than the limit of 1073741824 bytes");
}

TEST(DecodeImageFile, SaysWhyThereIsNoImage) {
  const TempDir dir;
  std::string reason;
  EXPECT_TRUE(DecodeImageFile(dir / "none.jpg", &reason).empty());
  EXPECT_EQ(reason, "cannot be read");
  std::ofstream(dir / "empty.jpg").close();
  EXPECT_TRUE(DecodeImageFile(dir / "empty.jpg", &reason).empty());
  EXPECT_EQ(reason, "the file is empty");
  std::ofstream(dir / "text.jpg") << "no picture";
  EXPECT_TRUE(DecodeImageFile(dir / "text.jpg", &reason).empty());
  EXPECT_EQ(reason, "not an image that can be decoded");
}

TEST(DecodeImageFile, PicturesAreNotTurnedByTheirMetadata) {
  // An EXIF orientation of 6 (turned by 90 degrees) in front of the JPEG's own segments.
  const TempDir dir;
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", PictureOfNoise(80, 60), jpeg);
  const std::vector<std::uint8_t> exif = {
      0xFF, 0xE1, 0x00, 0x22, 'E', 'x', 'i', 'f', 0, 0, 'M', 'M', 0, 42, 0, 0, 0, 8,
      0,    1,    0x01, 0x12, 0,   3,   0,   0,   0, 1, 0,   6,   0, 0,  0, 0, 0, 0};
  jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
  WriteBytes(dir / "a.jpg", jpeg);
  EXPECT_EQ(cv::imread(dir / "a.jpg").size(), cv::Size(60, 80)) << "the test's EXIF is not read";
  std::string reason;
  EXPECT_EQ(DecodeImageFile(dir / "a.jpg", &reason).size(), cv::Size(80, 60)) << reason;
}

}  // namespace
}  // namespace velamap
