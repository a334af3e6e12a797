#include "exporters/exchange/metashape_markers.h"

#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <pugixml.hpp>

#include "importer/base/error.h"
#include "importer/text/csv.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

pugi::xml_node ReadChunk(const Model& model, pugi::xml_document* document) {
  const std::string text = Written([&](std::ostream& out) { WriteMetashapeMarkers(model, out); });
  EXPECT_TRUE(document->load_string(text.c_str())) << text;
  return document->child("document").child("chunk");
}

std::map<int, std::string> LabelOfId(const pugi::xml_node& parent, const char* child) {
  std::map<int, std::string> label_of_id;
  for (const pugi::xml_node node : parent.children(child)) {
    const int id = node.attribute("id").as_int();
    EXPECT_TRUE(label_of_id.emplace(id, node.attribute("label").value()).second) << id;
  }
  return label_of_id;
}

// Reads numbers with a decimal point whatever the locale.
Eigen::Vector2d PixelOf(const pugi::xml_node& location) {
  std::istringstream numbers(std::string(location.attribute("x").value()) + " " +
                             location.attribute("y").value());
  numbers.imbue(std::locale::classic());
  Eigen::Vector2d x_in_image_px;
  numbers >> x_in_image_px.x() >> x_in_image_px.y();
  return x_in_image_px;
}

TEST(MetashapeMarkers, HoldEveryObservationUnderItsNames) {
  const CommaLocale comma_locale;
  Model model = ExampleModel();
  for (ModelImage& image : model.images) image.name = "left & right/" + image.name;
  pugi::xml_document document;
  const pugi::xml_node chunk = ReadChunk(model, &document);
  const auto camera_of_id = LabelOfId(chunk.child("cameras"), "camera");
  const auto marker_of_id = LabelOfId(chunk.child("markers"), "marker");
  EXPECT_EQ(camera_of_id.size(), model.images.size());
  EXPECT_EQ(marker_of_id.size(), model.points3D.size());

  const pugi::xml_node markers = chunk.child("frames").child("frame").child("markers");
  for (const pugi::xml_node marker : markers.children("marker")) {
    const Point3DId point3D_id = marker.attribute("marker_id").as_ullong();
    const CornerId corner = CornerFromPoint3DId(point3D_id);
    EXPECT_EQ(marker_of_id.at(static_cast<int>(point3D_id)),
              std::to_string(corner.marker_id) + "_" + std::to_string(corner.corner));
    auto element = model.points3D.at(point3D_id).track.begin();
    for (const pugi::xml_node location : marker.children("location")) {
      const ModelImage& image = *model.FindImage(element->image_id);
      const std::string label = camera_of_id.at(location.attribute("camera_id").as_int());
      EXPECT_EQ("left & right/" + label + ".jpg", image.name);
      EXPECT_EQ(PixelOf(location), image.points2D[element->point2D_idx].x_in_image_px);
      ++element;
    }
    EXPECT_EQ(element, model.points3D.at(point3D_id).track.end());
  }
}

TEST(MetashapeMarkers, TwoPicturesOfOneNameAreRefused) {
  Model model = ExampleModel();
  model.images[0].name = "port/1.jpg";
  model.images[1].name = "starboard/1.png";
  std::ostringstream out;
  EXPECT_THROW(WriteMetashapeMarkers(model, out), InputError);
}

TEST(MetashapeReference, HasEveryCornerWithItsAccuracy) {
  MarkerShape shape;
  shape.markers.resize(1);
  ShapeMarker& marker = shape.markers.front();
  marker.marker_id = 17;
  marker.x_in_shape_m[1] = Eigen::Vector3d(1.5, -0.25, 3.0);
  marker.sigma_m[1] = Eigen::Vector3d(0.003, 0.0, 0.0) * std::sqrt(3.0);
  marker.x_in_shape_m[3] = Eigen::Vector3d(0.0, 1e-9, 2.0);
  std::istringstream csv(Written([&](std::ostream& out) { WriteMetashapeReference(shape, out); }));
  const std::vector<CsvRecord> records = ReadCsv(csv, "reference.csv");
  ASSERT_EQ(records.size(), 3u);
  EXPECT_THAT(records[0].fields, testing::ElementsAre("label", "x", "y", "z", "accuracy"));
  EXPECT_THAT(records[1].fields, testing::ElementsAre("17_1", "1.5", "-0.25", "3", "0.003"));
  EXPECT_THAT(records[2].fields, testing::ElementsAre("17_3", "0", "1e-09", "2", ""));
}

}  // namespace
}  // namespace velamap
