#include "exporters/report/report_picture.h"

#include <fstream>

#include <gmock/gmock.h>

#include "importer/print/png_file.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

TEST(ReportPicture, Base64IsThatOfRfc4648) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(ReportPicture, LargeImagesShrink) {
  const TempDir dir;
  const std::string path = (dir / "large.png").string();
  std::ofstream(path) << EncodePng(cv::Mat(600, 900, CV_8UC3, cv::Scalar(10, 200, 30)));
  const ReportPicture small = MakeReportPicture(path, 90), large = MakeReportPicture(path, 2000);
  EXPECT_EQ(small.problem, "");
  EXPECT_EQ(small.jpeg_base64.substr(0, 4), "/9j/");  // ff d8 ff
  EXPECT_LT(2 * small.jpeg_base64.size(), large.jpeg_base64.size());
}

TEST(ReportPicture, SaysWhyThereIsNone) {
  const ReportPicture picture = MakeReportPicture("nowhere/image.jpg", 100);
  EXPECT_EQ(picture.jpeg_base64, "");
  EXPECT_EQ(picture.problem, "cannot be read");
}

}  // namespace
}  // namespace velamap
