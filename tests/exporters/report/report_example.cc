#include "tests/exporters/report/report_example.h"

#include <fstream>
#include <map>

#include <opencv2/imgproc.hpp>

#include "exporters/scale/metric_shape.h"
#include "importer/video/jpeg_codec.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/true_model.h"

namespace velamap {
namespace {

constexpr int kUnseenMarkerId = 8000;

}  // namespace

ReportInput ReportExample::Input() const {
  ReportInput input{model, layout, shape, metrics, model_metrics, scale, sail, freeform};
  input.title = "Example of a sail";
  input.version = "1.2.3";
  input.options = {{"image_path", "images"}, {"Registration.method", "global"}};
  return input;
}

Section StraightSection(const std::string& name, const Eigen::Vector3d& luff_in_frame_m,
                        const Eigen::Vector3d& leech_in_frame_m) {
  Section section;
  section.part = "sail";
  section.name = name;
  section.curve.degree = 1;
  section.curve.knots = Eigen::Array4d(0, 0, 1, 1);
  section.curve.poles_in_shape_m.resize(3, 2);
  section.curve.poles_in_shape_m << luff_in_frame_m, leech_in_frame_m;
  return section;
}

ReportExample MakeReportExample(int num_rows, int num_images) {
  SyntheticSceneOptions options;
  options.num_rows = num_rows;
  options.num_columns = 13;
  options.num_frames = num_images;
  SyntheticScene scene = MakeSyntheticScene(options);
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = 0.2;
  AddNoise(noise, &scene);
  ReportExample example;
  example.layout = scene.layout;
  example.layout.parts.front().marker_ids.push_back(kUnseenMarkerId);
  example.model = TrueModel(scene);
  example.shape = ShapeFromModel(example.model, example.layout);
  example.metrics = ComputeShapeMetrics(example.shape, example.layout);
  example.model_metrics = ComputeModelMetrics(example.model, MarkerIds(example.layout));
  example.scale = EstimateScale(example.model, example.layout);
  return example;
}

void DrawCentralImage(const Model& model, const std::filesystem::path& folder) {
  const ModelImage& image = model.images.front();
  const Camera& camera = model.cameras.at(image.camera_id);
  cv::Mat picture(camera.height_px, camera.width_px, CV_8UC3, cv::Scalar(190, 195, 200));
  std::map<int, std::vector<cv::Point>> outlines;
  for (const Point2D& point : image.points2D) {
    outlines[CornerFromPoint3DId(point.point3D_id).marker_id].emplace_back(
        cvRound(point.x_in_image_px.x()), cvRound(point.x_in_image_px.y()));
  }
  for (const auto& [marker_id, outline] : outlines) cv::fillConvexPoly(picture, outline, {0, 0, 0});
  std::ofstream(folder / image.name) << EncodeJpeg(picture, 95);
}

}  // namespace velamap
