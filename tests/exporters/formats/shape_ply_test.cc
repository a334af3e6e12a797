#include "exporters/formats/shape_ply.h"

#include <cmath>

#include <gmock/gmock.h>

#include "exporters/scale/metric_shape.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"
#include "tests/exporters/formats/ply_reader.h"
#include "tests/exporters/golden_file.h"

namespace velamap {
namespace {

using testing::ElementsAre;

constexpr PlyFormat kFormats[] = {PlyFormat::kAscii, PlyFormat::kBinaryLittleEndian};

std::string Points(const Model& model, PlyFormat format) {
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  return Written([&](std::ostream& out) { WritePointsPly(shape, model, format, out); });
}

std::string Markers(const Model& model, PlyFormat format) {
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  return Written([&](std::ostream& out) { WriteMarkersPly(shape, format, out); });
}

// Marker 2 has lost corner 3.
Model IncompleteModel() {
  Model model = ExampleModel();
  model.points3D.erase(Point3DIdFromCorner({2, 3}));
  return model;
}

// Markers 7, whole, 0.5 m at (1, 2, 3), and 12 with two corners.
Model GoldenModel() {
  Model model;
  const auto square = SquareMarker(7, 0.5, {Eigen::Quaterniond::Identity(), {1, 2, 3}});
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    Point3D& point = model.points3D[Point3DIdFromCorner({7, corner})];
    point.x_in_world = *square.x_in_shape_m[corner];
    point.color = {255, static_cast<std::uint8_t>(corner), 0};
  }
  model.points3D[121].x_in_world = {-0.5, 1e-9, 1e20};
  model.points3D[123].x_in_world = {0.1, 0.2, 0.3};
  model.points3D[123].color = {1, 2, 3};
  return model;
}

std::vector<Eigen::Vector3d> Vectors(const PlyReadElement& element, const std::string& x,
                                     const std::string& y, const std::string& z) {
  const auto xs = element.Column(x), ys = element.Column(y), zs = element.Column(z);
  std::vector<Eigen::Vector3d> vectors;
  for (std::size_t i = 0; i < xs.size(); ++i) vectors.emplace_back(xs[i], ys[i], zs[i]);
  return vectors;
}

std::vector<std::string> Signature(const PlyReadElement& element) {
  std::vector<std::string> signature;
  for (const PlyReadProperty& property : element.properties) {
    signature.push_back(
        (property.list_count_type.empty() ? "" : "list " + property.list_count_type + " ") +
        property.type + " " + property.name);
  }
  return signature;
}

TEST(PlyWriter, PropertiesAreTheOnesThatViewersKnow) {
  for (const PlyFormat format : kFormats) {
    const PlyFile points = ReadPly(Points(ExampleModel(), format));
    ASSERT_EQ(points.elements.size(), 1u);
    EXPECT_EQ(points.elements[0].name, "vertex");
    EXPECT_THAT(
        Signature(points.elements[0]),
        ElementsAre("double x", "double y", "double z", "float nx", "float ny", "float nz",
                    "uchar red", "uchar green", "uchar blue", "int marker_id", "int corner"));
    const PlyFile markers = ReadPly(Markers(ExampleModel(), format));
    ASSERT_EQ(markers.elements.size(), 2u);
    EXPECT_EQ(markers.elements[0].name, "vertex");
    EXPECT_THAT(
        Signature(markers.elements[0]),
        ElementsAre("double x", "double y", "double z", "float nx", "float ny", "float nz",
                    "uchar red", "uchar green", "uchar blue", "int marker_id", "int corner"));
    EXPECT_EQ(markers.elements[1].name, "face");
    EXPECT_THAT(Signature(markers.elements[1]),
                ElementsAre("list uchar int vertex_indices", "int marker_id"));
  }
}

TEST(PlyWriter, BothFormatsHoldTheSameNumbers) {
  const Model model = IncompleteModel();
  for (const auto& write : {Points, Markers}) {
    const PlyFile ascii = ReadPly(write(model, PlyFormat::kAscii));
    const PlyFile binary = ReadPly(write(model, PlyFormat::kBinaryLittleEndian));
    EXPECT_EQ(ascii.format, "ascii");
    EXPECT_EQ(binary.format, "binary_little_endian");
    ASSERT_EQ(ascii.elements.size(), binary.elements.size());
    for (std::size_t e = 0; e < ascii.elements.size(); ++e) {
      EXPECT_EQ(Signature(ascii.elements[e]), Signature(binary.elements[e]));
      ASSERT_EQ(ascii.elements[e].rows.size(), binary.elements[e].rows.size());
      for (std::size_t r = 0; r < ascii.elements[e].rows.size(); ++r) {
        for (std::size_t p = 0; p < ascii.elements[e].properties.size(); ++p) {
          const auto& a = ascii.elements[e].rows[r][p];
          const auto& b = binary.elements[e].rows[r][p];
          ASSERT_EQ(a.size(), b.size());
          for (std::size_t i = 0; i < a.size(); ++i) {
            const bool is_float = ascii.elements[e].properties[p].type == "float";
            // ASCII floats have the fewest digits that read back to the same float, not double.
            EXPECT_EQ(is_float ? static_cast<float>(a[i]) : a[i], b[i]);
          }
        }
      }
    }
  }
}

TEST(PlyWriter, PointsAreThoseOfTheModelExactly) {
  const Model model = IncompleteModel();
  const auto vertices = ReadPly(Points(model, PlyFormat::kBinaryLittleEndian)).elements[0];
  const auto x = Vectors(vertices, "x", "y", "z");
  const auto colors = Vectors(vertices, "red", "green", "blue");
  const auto marker_ids = vertices.Column("marker_id"), corners = vertices.Column("corner");
  EXPECT_EQ(x.size(), 7u * 5 + 3);  // marker 2 has no centre
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (corners[i] == 0) continue;
    const auto& point = model.points3D.at(
        Point3DIdFromCorner({static_cast<int>(marker_ids[i]), static_cast<int>(corners[i])}));
    EXPECT_EQ(x[i], point.x_in_world);
    EXPECT_EQ(colors[i], Eigen::Vector3d(point.color[0], point.color[1], point.color[2]));
  }
}

TEST(PlyWriter, NormalsAreUnitLengthOrZeroWithoutAWholeMarker) {
  const auto vertices = ReadPly(Points(IncompleteModel(), PlyFormat::kAscii)).elements[0];
  const auto normals = Vectors(vertices, "nx", "ny", "nz");
  const auto marker_ids = vertices.Column("marker_id");
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), marker_ids[i] == 2 ? 0.0 : 1.0, 1e-6) << marker_ids[i];
  }
}

TEST(PlyWriter, FacesRunCounterClockwiseSeenFromTheFront) {
  for (const PlyFormat format : kFormats) {
    const PlyFile file = ReadPly(Markers(IncompleteModel(), format));
    const auto x = Vectors(file.elements[0], "x", "y", "z");
    const auto normals = Vectors(file.elements[0], "nx", "ny", "nz");
    const auto vertex_marker_ids = file.elements[0].Column("marker_id");
    const auto faces = file.elements[1].ListColumn("vertex_indices");
    const auto face_marker_ids = file.elements[1].Column("marker_id");
    EXPECT_EQ(faces.size(), 7u);
    EXPECT_EQ(x.size(), 28u);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      ASSERT_EQ(faces[i].size(), 4u);
      for (const double index : faces[i]) {
        EXPECT_EQ(vertex_marker_ids.at(index), face_marker_ids[i]);
      }
      // Right-hand rule at every vertex of the face.
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d& before = x.at(faces[i][k]);
        const Eigen::Vector3d& here = x.at(faces[i][(k + 1) % 4]);
        const Eigen::Vector3d& after = x.at(faces[i][(k + 2) % 4]);
        const Eigen::Vector3d normal = (here - before).cross(after - here).normalized();
        EXPECT_NEAR((normal - normals.at(faces[i][k])).norm(), 0, 1e-6);
      }
    }
  }
}

TEST(PlyWriter, Golden) {
  EXPECT_EQ(Points(GoldenModel(), PlyFormat::kAscii), Golden("points.ply"));
  EXPECT_EQ(Markers(GoldenModel(), PlyFormat::kAscii), Golden("markers.ply"));
}

TEST(PlyWriter, IsTheSameInAnyLocale) {
  for (const PlyFormat format : kFormats) {
    const std::string points = Points(ExampleModel(), format);
    const std::string markers = Markers(ExampleModel(), format);
    const CommaLocale locale;
    EXPECT_EQ(Points(ExampleModel(), format), points);
    EXPECT_EQ(Markers(ExampleModel(), format), markers);
  }
}

TEST(PlyWriter, NoMarkersMakeAValidEmptyFile) {
  for (const PlyFormat format : kFormats) {
    EXPECT_EQ(ReadPly(Points(Model(), format)).elements.at(0).rows.size(), 0u);
    EXPECT_EQ(ReadPly(Markers(Model(), format)).elements.at(1).rows.size(), 0u);
  }
}

TEST(PlyWriter, SigmasAreThereWhereAllPointsHaveOne) {
  const Model model = ExampleModel();
  const PointCovariance covariance = ExampleCovariance(model, 1e-4, 1);
  MarkerShape shape = ShapeFromModel(model, ExampleLayout(), &covariance);
  for (const PlyFormat format : kFormats) {
    const auto points = [&](std::ostream& out) { WritePointsPly(shape, model, format, out); };
    const auto markers = [&](std::ostream& out) { WriteMarkersPly(shape, format, out); };
    const PlyReadElement vertices = ReadPly(Written(points)).elements[0];
    EXPECT_EQ(Signature(vertices).back(), "float sigma");
    const double expected = shape.markers[0].sigma_m[1]->norm() / std::sqrt(3.0);
    EXPECT_NEAR(vertices.Column("sigma").at(1), expected, 1e-6 * expected);
    const PlyReadElement corners = ReadPly(Written(markers)).elements[0];
    EXPECT_EQ(Signature(corners).back(), "float sigma");
    EXPECT_NEAR(corners.Column("sigma").at(0), expected, 1e-6 * expected);
    const auto sigma_m = shape.markers[2].sigma_m[0];
    shape.markers[2].sigma_m[0].reset();  // a centre is in one of the files only
    EXPECT_EQ(Signature(ReadPly(Written(points)).elements[0]).back(), "int corner");
    EXPECT_EQ(Signature(ReadPly(Written(markers)).elements[0]).back(), "float sigma");
    shape.markers[2].sigma_m[0] = sigma_m;
  }
}

}  // namespace
}  // namespace velamap
