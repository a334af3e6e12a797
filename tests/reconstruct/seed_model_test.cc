#include "reconstruct/seed_model.h"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/text/csv.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/register_frames.h"
#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

Registration Register(const SyntheticScene& scene) {
  return RegisterFrames(DatabaseImages(scene), SceneCameras(scene), scene.layout, {});
}

TEST(SeedModel, NoiseFreeSceneReprojectsOntoItsKeypoints) {
  const SyntheticScene scene = MakeScene(SceneKind::kCube, 24, false);
  const Registration registration = Register(scene);
  const Model model = MakeSeedModel(registration, DatabaseImages(scene), SceneCameras(scene));
  CheckModel(model);
  EXPECT_EQ(model.images.front().image_id, registration.central_image_id);
  EXPECT_LT(SummarizeReprojectionErrors(model).max, 1e-5);
  std::size_t num_observations = 0, num_seen = 0;
  for (const auto& [id, point] : model.points3D) num_observations += point.track.size();
  for (const FrameDetections& frame : scene.frames) {
    for (const MarkerDetection& marker : frame.markers) {
      if (model.points3D.count(Point3DIdFromCorner({marker.marker_id, 1}))) num_seen += 4;
    }
  }
  EXPECT_EQ(num_observations, num_seen);  // tracks are complete
}

TEST(SeedModel, RegistrationTableGivesReasonsOfOutliers) {
  Registration registration;
  registration.frames.push_back(
      {1, "a.jpg", Rigid3{}, {}, {3, 9}, {{5, "too far"}, {6, "turned"}}, 0.001});
  std::ostringstream csv;
  WriteRegistrationCsv(registration, csv);
  EXPECT_THAT(csv.str(), testing::EndsWith("a.jpg,1,2,2,1,,5: too far; 6: turned\n"));
}

TEST(SeedModel, RegistrationTableReadsBackWithAnyName) {
  Registration registration;
  RegisteredFrame frame{1, "c,am \"00\".jpg", Rigid3{}, {}, {3}, {{5, "a \"b\", c"}}, 0.001};
  frame.left_out.reason = "no, \"none\"";
  registration.frames.push_back(frame);
  std::stringstream csv;
  WriteRegistrationCsv(registration, csv);
  const std::vector<CsvRecord> records = ReadCsv(csv, "registration.csv");
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].fields.size(), 7u);
  EXPECT_THAT(records[1].fields, testing::ElementsAre("c,am \"00\".jpg", "1", "1", "1", "1",
                                                      "no, \"none\"", "5: a \"b\", c"));
}

TEST(SeedModel, RegistrationTableNamesEveryImage) {
  const SyntheticScene scene = MakeScene(SceneKind::kSail, 6, true);
  std::ostringstream csv;
  WriteRegistrationCsv(Register(scene), csv);
  const std::string text = csv.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 7);
  EXPECT_THAT(text, testing::HasSubstr("frame_000005.jpg,1,"));
}

}  // namespace
}  // namespace velamap
