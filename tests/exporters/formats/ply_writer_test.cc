#include "exporters/formats/ply_writer.h"

#include <numeric>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/formats/ply_reader.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string WrittenPly(PlyFormat format, int num_rows) {
  PlyElement<int> points{"vertex", std::vector<int>(static_cast<std::size_t>(num_rows)), {}};
  std::iota(points.rows.begin(), points.rows.end(), 0);
  points.Add("x", PlyType::kDouble, [](int i) { return i / 3.0; });
  points.Add("nx", PlyType::kFloat, [](int i) { return -0.1 * i; });
  points.Add("red", PlyType::kUchar, [](int i) { return i % 256; });
  points.Add("marker_id", PlyType::kInt, [](int i) { return -i; });
  points.AddList("neighbours", PlyType::kInt, 2, [](int i, int k) { return i + k; });
  PlyElement<double> others{"other", {0.5}, {}};
  others.Add("value", PlyType::kDouble, [](double x) { return x; });
  std::ostringstream out;
  WritePly(format, {"one\ntwo", "three"}, out, points, others);
  return out.str();
}

// The bodies are longer than the chunks in which they are written.
TEST(PlyWriter, BothFormatsReadBackWithAllRows) {
  constexpr int kNumRows = 20000;
  for (const PlyFormat format : {PlyFormat::kAscii, PlyFormat::kBinaryLittleEndian}) {
    const PlyFile file = ReadPly(WrittenPly(format, kNumRows));
    ASSERT_EQ(file.elements.size(), 2u);
    const PlyReadElement& points = file.elements[0];
    ASSERT_EQ(points.rows.size(), static_cast<std::size_t>(kNumRows));
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      const auto number = static_cast<double>(i);
      EXPECT_THAT(points.rows[i][0], ElementsAre(number / 3.0));
      EXPECT_FLOAT_EQ(static_cast<float>(points.rows[i][1][0]), static_cast<float>(-0.1 * number));
      EXPECT_THAT(points.rows[i][2], ElementsAre(static_cast<double>(i % 256)));
      EXPECT_THAT(points.rows[i][3], ElementsAre(-number));
      EXPECT_THAT(points.rows[i][4], ElementsAre(number, number + 1));
    }
    EXPECT_THAT(file.elements[1].Column("value"), ElementsAre(0.5));
  }
}

TEST(PlyWriter, HeaderKeepsEachCommentOnOneLine) {
  EXPECT_THAT(WrittenPly(PlyFormat::kAscii, 1),
              HasSubstr("ply\nformat ascii 1.0\ncomment one two\ncomment three\nelement vertex 1\n"
                        "property double x\nproperty float nx\nproperty uchar red\n"
                        "property int marker_id\nproperty list uchar int neighbours\n"));
}

}  // namespace
}  // namespace velamap
