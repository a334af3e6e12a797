#include "exporters/shape_json.h"

#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"
#include "tests/support/scoped_date.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::Pair;

const ShapeFrame kFrame = {{}, "lines h1 h2", "x aft", {"no hull"}, {}};

std::string Text(const Model& model, const ShapeOrigin& origin, const DescribedFiles& files = {},
                 const Verdict* verdict = nullptr) {
  return Written(
      [&](std::ostream& out) { WriteShapeJson(kFrame, model, 7, origin, verdict, files, out); });
}

nlohmann::json Json(const Model& model, const ShapeOrigin& origin,
                    const DescribedFiles& files = {}) {
  return nlohmann::json::parse(Text(model, origin, files));
}

TEST(ShapeJson, SaysWhatTheTablesDoNot) {
  const ScopedDate date("1700000000");
  const Model model = ExampleModel();
  const auto root = Json(model, {"1.2.3", "clip.mp4", true}, {{"shape.csv", "markers"}});
  EXPECT_EQ(root.at("velamap_version"), "1.2.3");
  EXPECT_EQ(root.at("clip"), "clip.mp4");
  EXPECT_EQ(root.at("date"), "2023-11-14T22:13:20Z");
  EXPECT_EQ(root.at("frame"),
            nlohmann::json(
                {{"name", "lines h1 h2"}, {"description", "x aft"}, {"reasons", {"no hull"}}}));
  EXPECT_EQ(root.at("units").at("length"), "m");
  EXPECT_EQ(root.at("num_markers"), 7);
  EXPECT_EQ(root.at("num_images"), model.images.size());
  EXPECT_EQ(root.at("files"), nlohmann::json({{"shape.csv", "markers"}}));
  ASSERT_EQ(root.at("cameras").size(), 1u);
  EXPECT_EQ(root.at("cameras")[0].at("num_images"), model.images.size());
  EXPECT_EQ(root.at("cameras")[0].at("found_without_calibration"), true);
}

TEST(ShapeJson, WhatIsUnknownHasNoKey) {
  const auto root = Json(ExampleModel(), {});
  EXPECT_FALSE(root.contains("clip"));
  EXPECT_FALSE(root.contains("velamap_version"));
  EXPECT_FALSE(root.contains("verdict"));
  EXPECT_FALSE(root.at("cameras")[0].contains("found_without_calibration"));
  EXPECT_THAT(Text(ExampleModel(), {}), testing::Not(testing::HasSubstr("null")));
}

// The file is shared, so its reasons must not name folders.
TEST(ShapeJson, HasTheVerdictWithItsReasons) {
  const Verdict verdict = {ReportStatus::kBad,
                           {{ReportStatus::kBad, "the calibration /home/me/camera.yml is another"},
                            {ReportStatus::kCheck, "few images"}}};
  const std::string text = Text(ExampleModel(), {}, {}, &verdict);
  EXPECT_EQ(nlohmann::json::parse(text).at("verdict"), nlohmann::json::parse(R"({"level": "bad",
      "reasons": [{"level": "bad", "text": "the calibration camera.yml is another"},
                  {"level": "check", "text": "few images"}]})"));
  const Verdict good;
  EXPECT_EQ(nlohmann::json::parse(Text(ExampleModel(), {}, {}, &good)).at("verdict"),
            nlohmann::json::parse(R"({"level": "good", "reasons": []})"));
}

// The parameters of all models have COLMAP's names; a camera without images is not listed.
TEST(ShapeJson, CamerasHaveTheirParametersByName) {
  const struct {
    CameraModel model;
    std::vector<std::string> names;
  } cases[] = {
      {CameraModel::kSimplePinhole, {"f", "cx", "cy"}},
      {CameraModel::kPinhole, {"fx", "fy", "cx", "cy"}},
      {CameraModel::kSimpleRadial, {"f", "cx", "cy", "k1"}},
      {CameraModel::kRadial, {"f", "cx", "cy", "k1", "k2"}},
      {CameraModel::kOpenCV, {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}},
      {CameraModel::kOpenCVFisheye, {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}},
      {CameraModel::kFullOpenCV,
       {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
  };
  for (const auto& c : cases) {
    Camera camera{c.model, 1920, 1080, {}};
    while (camera.params.size() < c.names.size()) camera.params.push_back(camera.params.size());
    Model model;
    model.cameras = {{3, camera}, {4, camera}};
    model.images.resize(2);
    for (ModelImage& image : model.images) image.camera_id = 3;
    const auto cameras = Json(model, {}).at("cameras");
    ASSERT_EQ(cameras.size(), 1u);
    EXPECT_EQ(cameras[0].at("camera_id"), 3);
    EXPECT_EQ(cameras[0].at("model"), CameraModelName(c.model));
    EXPECT_EQ(cameras[0].at("width_px"), 1920);
    EXPECT_EQ(cameras[0].at("height_px"), 1080);
    EXPECT_EQ(cameras[0].at("num_images"), 2);
    ASSERT_EQ(cameras[0].at("params").size(), c.names.size());
    for (std::size_t i = 0; i < c.names.size(); ++i) {
      EXPECT_EQ(cameras[0].at("params").at(c.names[i]), camera.params[i]) << c.names[i];
    }
  }
}

TEST(ShapeJson, NeitherLocaleNorOddNamesHarmIt) {
  const ScopedDate date("1700000000");
  const ShapeOrigin origin{"1.2.3", "a \"b\"\n\xFF.mp4", false};
  const std::string text = Text(ExampleModel(), origin);
  EXPECT_EQ(Json(ExampleModel(), origin).at("clip"), "a \"b\"\n\xEF\xBF\xBD.mp4");
  const CommaLocale comma_locale;
  EXPECT_EQ(Text(ExampleModel(), origin), text);
}

TEST(ShapeJson, FilesOfFurtherPartsAreDescribedAsThoseOfTheFirst) {
  const TempDir dir;
  for (const char* name : {"surface.obj", "surface_2.obj", "surface_12_ansys.txt", "notes.txt",
                           "surface_residuals_2.csv"}) {
    std::ofstream(dir / name) << "text";
  }
  const DescribedFiles files = DescribeShapeFiles(dir.path(), LengthUnit::kMillimetre);
  EXPECT_THAT(files, ElementsAre(Pair("surface.obj", EndsWith(", mm")),
                                 Pair("surface_12_ansys.txt", EndsWith("ANSYS, mm")),
                                 Pair("surface_2.obj", files.at(0).second),
                                 Pair("surface_residuals_2.csv", EndsWith(", m"))));
}

// A part without enough markers has no files, so that the numbers are not those of the layout.
TEST(ShapeJson, FilesOfAFreeformSurfaceNameTheirPart) {
  const TempDir dir;
  for (const char* name : {"freeform.ply", "freeform_2.ply", "freeform_2.stl"}) {
    std::ofstream(dir / name) << "text";
  }
  const DescribedFiles files = DescribeShapeFiles(dir.path(), LengthUnit::kMetre,
                                                  {{"freeform", "face0"}, {"freeform_2", "face3"}});
  EXPECT_THAT(files, ElementsAre(Pair("freeform.ply", EndsWith(", m; part face0")),
                                 Pair("freeform_2.ply", EndsWith(", m; part face3")),
                                 Pair("freeform_2.stl", EndsWith(", m; part face3"))));
}

}  // namespace
}  // namespace velamap
