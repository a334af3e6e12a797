#include "exporters/formats/shape_csv.h"

#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"
#include "tests/exporters/golden_file.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr char kHeader[] = "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n";

std::string Write(const MarkerShape& shape) {
  return Written([&](std::ostream& out) { WriteShapeCsv(shape, out); });
}

MarkerShape Read(const std::string& text) {
  std::istringstream in(text);
  return ReadShapeCsv(in, "a.csv");
}

std::string ErrorOf(const std::string& text) {
  try {
    Read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void ExpectEqual(const MarkerShape& a, const MarkerShape& b) {
  ASSERT_EQ(a.markers.size(), b.markers.size());
  for (std::size_t i = 0; i < a.markers.size(); ++i) {
    EXPECT_EQ(a.markers[i].marker_id, b.markers[i].marker_id);
    EXPECT_EQ(a.markers[i].part, b.markers[i].part);
    EXPECT_EQ(a.markers[i].x_in_shape_m, b.markers[i].x_in_shape_m);
    EXPECT_EQ(a.markers[i].sigma_m, b.markers[i].sigma_m);
    EXPECT_EQ(a.markers[i].num_frames, b.markers[i].num_frames);
  }
}

// Markers at arbitrary positions with every kind of gap, and numbers of all magnitudes.
MarkerShape RandomShape(std::uint32_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return 2.0 * std::ldexp(random() >> 11, -53) - 1.0; };
  MarkerShape shape;
  for (int marker_id = 0; marker_id <= kMaxMarkerId; marker_id += 1021) {
    Rigid3 shape_from_marker;
    shape_from_marker.translation = {1e6 * uniform(), uniform(), 1e-9 * uniform()};
    ShapeMarker marker = SquareMarker(marker_id, 0.3 + 0.1 * uniform(), shape_from_marker);
    marker.num_frames = {1000, 1234567, 2, 3, std::numeric_limits<int>::max()};
    marker.part =
        std::vector<std::string>{"", "sail", "hull, \"port\"", "two\nlines"}[marker_id % 4];
    for (auto& sigma_m : marker.sigma_m) {
      if (uniform() > 0) sigma_m = 1e-3 * Eigen::Vector3d(uniform(), uniform(), 0).cwiseAbs();
    }
    if (uniform() > 0) {
      for (const int corner : {0, 3}) {
        marker.x_in_shape_m[corner].reset();
        marker.sigma_m[corner].reset();
        marker.num_frames[corner] = 0;
      }
    }
    shape.markers.push_back(marker);
  }
  shape.markers[0].x_in_shape_m[1]->z() = std::numeric_limits<double>::denorm_min();
  shape.markers[0].x_in_shape_m[2]->z() = -0.0;
  return shape;
}

TEST(ShapeCsv, RoundTripIsExact) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const MarkerShape shape = RandomShape(seed);
    ExpectEqual(Read(Write(shape)), shape);
  }
}

TEST(ShapeCsv, RoundTripIsExactWithDecimalCommas) {
  const MarkerShape shape = RandomShape(6);
  const std::string expected = Write(shape);
  const CommaLocale locale;
  EXPECT_EQ(Write(shape), expected);
  ExpectEqual(Read(expected), shape);
}

TEST(ShapeCsv, Golden) {
  MarkerShape shape;
  Rigid3 shape_from_marker;
  shape_from_marker.translation = {1.25, -2, 3};
  shape.markers.push_back(SquareMarker(7, 0.5, shape_from_marker));
  shape.markers.push_back(SquareMarker(20, 0.25));
  shape.markers[0].part = "sail";
  shape.markers[0].sigma_m[2] = Eigen::Vector3d(0.001, 0.0002, 1e-7);
  shape.markers[1].part = "hull, port";
  for (const int corner : {0, 4}) shape.markers[1].x_in_shape_m[corner].reset();
  EXPECT_EQ(Write(shape), Golden("shape.csv"));
}

TEST(ShapeCsv, RowsComeInAnyOrderAndCentresMayBeLeftOut) {
  const std::string text = std::string("\xEF\xBB\xBF") + kHeader +
                           "# by hand\r\n"
                           "9,4,0,0,0,,,,5,\r\n"
                           "3,1,1,1,1,,,,1,\r\n"
                           "9,2, 1 ,1,0,,,,4,\r\n"
                           "9,1,0,1,0,,,,6,\r\n"
                           "9,3,1,0,0,,,,7,\r\n";
  const MarkerShape shape = Read(text);
  ASSERT_EQ(shape.markers.size(), 2u);
  EXPECT_EQ(shape.markers[0].marker_id, 3);
  EXPECT_FALSE(shape.markers[0].IsWhole());
  ASSERT_TRUE(shape.markers[1].IsWhole());
  EXPECT_EQ(*shape.markers[1].x_in_shape_m[0], Eigen::Vector3d(0.5, 0.5, 0));
  EXPECT_EQ(shape.markers[1].num_frames[0], 4);
}

// As earlier versions wrote them.
TEST(ShapeCsv, LinesWithANumberSignMayPrecedeTheHeader) {
  const MarkerShape shape = RandomShape(7);
  const std::string text = Write(shape);
  EXPECT_THAT(text, StartsWith(kHeader));
  ExpectEqual(Read("# frame lines h1 v1: origin at marker 100, \"z\" up; no hull\n#\n" + text),
              shape);
}

TEST(ShapeCsv, ACentreRoundedToMillimetresIsTaken) {
  const MarkerShape shape = Read(std::string(kHeader) +
                                 "1,1,0,0.101,0,,,,1,\n1,2,0.1,0.1,0,,,,1,\n"
                                 "1,3,0.1,0,0,,,,1,\n1,4,0,0,0,,,,1,\n1,0,0.05,0.050,0,,,,1,\n");
  EXPECT_EQ(*shape.markers.at(0).x_in_shape_m[0], Eigen::Vector3d(0.05, 0.05, 0));
}

TEST(ShapeCsv, ErrorsNameFileLineAndColumn) {
  const std::string h = kHeader;
  const struct {
    std::string text, expected;
  } cases[] = {
      {"", "a.csv:1: expected the header marker_id,corner,x,y,z,"},
      {"marker_id;corner;x\n", "a.csv:1: expected the header"},
      {"# note\nmarker_id,corner,x,y,z\n", "a.csv:2: expected the header"},
      {h, "a.csv: no marker follows the header"},
      {h + "1,1,0,0,0,,,,3\n", "a.csv:2: 9 columns, expected the 10 of marker_id"},
      {h + "1,1,0,0,0,,,,3,sail\n1,2,0,0,0,,,,3,sail,\n", "a.csv:3: 11 columns"},
      {h + "one,1,0,0,0,,,,3,\n", "a.csv:2: column marker_id: expected an integer from 0 to 8191"},
      {h + "8192,1,0,0,0,,,,3,\n", "a.csv:2: column marker_id: expected an integer"},
      {h + "-1,1,0,0,0,,,,3,\n", "a.csv:2: column marker_id: expected an integer"},
      {h + "1.5,1,0,0,0,,,,3,\n", "a.csv:2: column marker_id: expected an integer"},
      {h + "\n1,5,0,0,0,,,,3,\n", "a.csv:3: column corner: expected an integer from 0 to 4"},
      {h + "1,1,abc,0,0,,,,3,\n", "a.csv:2: column x: expected a number in metres"},
      {h + "1,1,0,,0,,,,3,\n", "a.csv:2: column y: expected a number in metres"},
      {h + "1,1,0,0,1.5m,,,,3,\n", "a.csv:2: column z: expected a number in metres"},
      {h + "1,1,0,0,\"1,5\",,,,3,\n", "a.csv:2: column z: expected a number in metres"},
      {h + "1,1,0,nan,0,,,,3,\n", "a.csv:2: column y: expected a number in metres"},
      {h + "1,1,0,0,inf,,,,3,\n", "a.csv:2: column z: expected a number in metres"},
      {h + "1,1,0,0,0,1,,1,3,\n", "a.csv:2: column sigma_y: expected a number from 0"},
      {h + "1,1,0,0,0,1,1,-1,3,\n", "a.csv:2: column sigma_z: expected a number from 0"},
      {h + "1,1,0,0,0,,,,,\n", "a.csv:2: column num_frames: expected an integer"},
      {h + "1,1,0,0,0,,,,-2,\n", "a.csv:2: column num_frames: expected an integer"},
      {h + "1,1,0,0,0,,,,3,a\n1,1,0,0,0,,,,3,a\n", "a.csv:3: column corner: corner 1 of marker 1"},
      {h + "1,1,0,0,0,,,,3,a\n1,2,0,0,0,,,,3,b\n", "a.csv:3: column part: marker 1 is on 'b'"},
      {h + "1,1,0,0,0,,,,3,\n1,0,0,0,0,,,,3,\n",
       "a.csv:3: column corner: marker 1: a centre without its four corners"},
      {h + "1,0,0,0,2,,,,3,\n1,1,0,1,0,,,,3,\n1,2,1,1,0,,,,3,\n1,3,1,0,0,,,,3,\n1,4,0,0,0,,,,3,\n",
       "a.csv:2: column corner: marker 1: the centre is 2.12 m from the mean of its corners"},
      {h + "1,1,0,0,0,,,,3,\"sail\n", "a.csv:2: a quote is opened and never closed"},
  };
  for (const auto& c : cases) EXPECT_THAT(ErrorOf(c.text), StartsWith(c.expected)) << c.text;
}

TEST(ShapeCsv, APathIsReadAndABadOneNamed) {
  const TempDir dir;
  const std::string path = dir / "shape.csv";
  std::ofstream(path) << kHeader << "4,1,1,2,3,,,,1,\n";
  EXPECT_EQ(ReadShapeCsv(path).markers.at(0).marker_id, 4);
  for (const std::string& bad : {(dir / "none.csv").string(), dir.path().string()}) {
    try {
      ReadShapeCsv(bad);
      FAIL() << "no error for " << bad;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith(bad));
      EXPECT_THAT(error.what(),
                  AnyOf(HasSubstr("cannot be opened"), HasSubstr("is not a regular file")));
    }
  }
}

}  // namespace
}  // namespace velamap
