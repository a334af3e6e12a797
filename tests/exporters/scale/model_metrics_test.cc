#include "exporters/scale/model_metrics.h"

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;

std::vector<int> LayoutIds() { return MarkerIds(ExampleLayout()); }

std::vector<std::string> NamesOf(const ModelMetrics& metrics) {
  std::vector<std::string> names;
  for (const ImageMetrics& image : metrics.images) names.push_back(image.image_name);
  return names;
}

// Moves every image point of one image.
void Shift(const Eigen::Vector2d& shift_px, ModelImage* image) {
  for (Point2D& point : image->points2D) point.x_in_image_px += shift_px;
}

TEST(ModelMetrics, AnExactModelHasNoErrorInAnyWorldFrame) {
  Model model = ExampleModel();
  TransformModel(ExampleSim3(4.0), &model);
  const ModelMetrics metrics = ComputeModelMetrics(model, LayoutIds());
  EXPECT_EQ(metrics.error_px.count, 3 * 8 * 4);
  EXPECT_EQ(metrics.central_error_px.count, 8 * 4);
  EXPECT_LT(metrics.error_px.max, 1e-8);
  EXPECT_EQ(metrics.num_behind_camera, 0);
  EXPECT_EQ(metrics.marker_ratio.count, 3);
  EXPECT_EQ(metrics.marker_ratio.min, 1.0);
}

TEST(ModelMetrics, TheCentralImageIsTheFirstOfTheModel) {
  Model model = ExampleModel();
  std::swap(model.images[0], model.images[2]);
  Shift({3.0, 4.0}, &model.images[0]);  // 5 px
  Shift({1.0, 0.0}, &model.images[1]);
  const ModelMetrics metrics = ComputeModelMetrics(model, LayoutIds());
  EXPECT_EQ(metrics.central_image_name, "image3.jpg");
  EXPECT_NEAR(metrics.central_error_px.mean, 5.0, 1e-8);
  EXPECT_NEAR(metrics.central_error_px.standard_deviation, 0.0, 1e-8);
  EXPECT_NEAR(metrics.error_px.mean, 2.0, 1e-8);
  EXPECT_NEAR(metrics.error_px.median, 1.0, 1e-8);
  EXPECT_NEAR(metrics.error_px.max, 5.0, 1e-8);
  EXPECT_THAT(NamesOf(metrics), ElementsAre("image1.jpg", "image2.jpg", "image3.jpg"));
  EXPECT_NEAR(metrics.images[1].error_px.mean, 1.0, 1e-8);
  EXPECT_NEAR(metrics.images[2].error_px.mean, 5.0, 1e-8);
}

TEST(ModelMetrics, ErrorsOfTheImagesAddUpToTheWhole) {
  Model model = ExampleModel();
  AddImageNoise(0.7, 11, &model);
  const ModelMetrics metrics = ComputeModelMetrics(model, LayoutIds());
  double sum = 0.0, max = 0.0;
  int count = 0;
  for (const ImageMetrics& image : metrics.images) {
    sum += image.error_px.count * image.error_px.mean;
    count += image.error_px.count;
    max = std::max(max, image.error_px.max);
  }
  EXPECT_EQ(count, metrics.error_px.count);
  EXPECT_NEAR(sum / count, metrics.error_px.mean, 1e-12);
  EXPECT_EQ(max, metrics.error_px.max);
}

TEST(ModelMetrics, TheRatioCountsMarkersThatAnImageSeesWhole) {
  Model model = ExampleModel();
  const ImageId image_id = model.images[1].image_id;
  for (const CornerId corner : {CornerId{1, 2}, CornerId{3, 4}}) {
    const Point3DId id = Point3DIdFromCorner(corner);
    RemoveObservation(&model, id, model.points3D.at(id).track.at(1));
  }
  std::vector<int> ids = LayoutIds();
  ids.pop_back();       // 121 is seen, but the layout does not name it
  ids.push_back(4000);  // nowhere seen
  const ModelMetrics metrics = ComputeModelMetrics(model, ids);
  ASSERT_EQ(model.images[1].image_id, image_id);
  EXPECT_EQ(metrics.images[0].num_markers, 8);
  EXPECT_EQ(metrics.images[1].num_markers, 6);
  EXPECT_DOUBLE_EQ(metrics.images[0].marker_ratio.value(), 7.0 / 8.0);
  EXPECT_DOUBLE_EQ(metrics.images[1].marker_ratio.value(), 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(metrics.marker_ratio.min, 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(metrics.marker_ratio.median, 7.0 / 8.0);
}

TEST(ModelMetrics, WithoutAListOfMarkersThereIsNoRatio) {
  const ModelMetrics metrics = ComputeModelMetrics(ExampleModel(), {});
  EXPECT_EQ(metrics.marker_ratio.count, 0);
  EXPECT_FALSE(metrics.images[0].marker_ratio);
  EXPECT_EQ(metrics.images[0].num_markers, 8);
}

TEST(ModelMetrics, APointBehindItsCameraIsCountedAndSpoilsNoMean) {
  Model model = ExampleModel();
  model.points3D.at(Point3DIdFromCorner({2, 3})).x_in_world.z() = 50.0;  // cameras are at z = 6
  const ModelMetrics metrics = ComputeModelMetrics(model, LayoutIds());
  EXPECT_EQ(metrics.num_behind_camera, 3);
  EXPECT_EQ(metrics.error_px.count, 3 * 8 * 4 - 3);
  EXPECT_LT(metrics.error_px.max, 1e-8);
}

TEST(ModelMetrics, AModelWithoutImagesIsSaid) {
  EXPECT_THROW(ComputeModelMetrics(Model(), {}), DataError);
}

}  // namespace
}  // namespace velamap
