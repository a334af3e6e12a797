#include "exporters/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "importer/base/error.h"
#include "tests/exporters/report/report_example.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

double Number(const json& value) { return value.get<double>(); }

Eigen::Vector3d VectorOf(const json& value) {
  return {Number(value.at(0)), Number(value.at(1)), Number(value.at(2))};
}

class ReportData : public testing::Test {
 protected:
  json Parsed() const { return json::parse(ReportJson(example_.Input())); }

  const ReportExample example_ = MakeReportExample(2, 4);
};

TEST_F(ReportData, HasEveryMarkerWithItsNumbers) {
  const json markers = Parsed().at("markers");
  ASSERT_EQ(markers.size(), example_.shape.markers.size());
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const ShapeMarker& marker = example_.shape.markers[i];
    EXPECT_EQ(markers[i].at("id"), marker.marker_id);
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      EXPECT_EQ(VectorOf(markers[i].at("corners").at(corner - 1)), marker.x_in_shape_m[corner]);
    }
    EXPECT_NEAR(markers[i].at("area_deviation_percent").get<double>(), 0, 1e-9);
    EXPECT_NEAR(markers[i].at("scale_deviation_percent").get<double>(), 0, 1e-9);
    EXPECT_FALSE(markers[i].contains("sigma_mm"));
  }
}

TEST_F(ReportData, MarkerErrorsAverageToTheModels) {
  double sum_px = 0;
  int count = 0;
  const json data = Parsed();
  for (const json& marker : data.at("markers")) {
    const int num_observations = marker.at("num_observations");
    sum_px += num_observations * Number(marker.at("error_px"));
    count += num_observations;
  }
  EXPECT_EQ(count, example_.model_metrics.error_px.count);
  EXPECT_NEAR(sum_px / count, example_.model_metrics.error_px.mean, 1e-12);
}

TEST_F(ReportData, AMarkerTooSmallByTwoPercentSaysSo) {
  ReportExample example = example_;
  ShapeMarker& marker = example.shape.markers.front();
  const Eigen::Vector3d centre = *marker.x_in_shape_m[0];
  for (auto& x : marker.x_in_shape_m) x = centre + 0.98 * (*x - centre);
  const json first = json::parse(ReportJson(example.Input())).at("markers").at(0);
  EXPECT_NEAR(Number(first.at("side_deviation_percent")), -2, 1e-9);
  EXPECT_NEAR(Number(first.at("area_deviation_percent")), -3.96, 1e-9);
}

TEST_F(ReportData, CamerasStandAndLookWhereTheModelHasThem) {
  const json images = Parsed().at("images");
  ASSERT_EQ(images.size(), 4u);
  EXPECT_TRUE(images[0].contains("central"));
  for (std::size_t i = 0; i < images.size(); ++i) {
    const ModelImage& image = example_.model.images[i];
    EXPECT_EQ(images[i].at("name"), image.name);
    const Eigen::Vector3d centre = VectorOf(images[i].at("centre"));
    EXPECT_LT((image.cam_from_world * centre).norm(), 1e-12);
    const Eigen::Vector3d top_left_in_cam =
        image.cam_from_world * (centre + VectorOf(images[i].at("frustum").at(0)));
    EXPECT_NEAR(top_left_in_cam.z(), 1, 1e-12);
    EXPECT_LT(top_left_in_cam.x(), 0);
    EXPECT_LT(top_left_in_cam.y(), 0);
  }
}

TEST_F(ReportData, HistogramsCountAllMarkersAndCorners) {
  const json data = Parsed();
  const auto total = [&](const char* name) {
    const json& histogram = data.at("histograms").at(name);
    const std::vector<int> counts = histogram.at("counts");
    return std::accumulate(counts.begin(), counts.end(), 0) + histogram.at("num_below").get<int>() +
           histogram.at("num_above").get<int>();
  };
  EXPECT_EQ(total("area_deviation_percent"), example_.metrics.num_markers);
  EXPECT_EQ(total("error_px"), example_.model_metrics.error_px.count);
}

TEST_F(ReportData, EllipsoidsHaveTheMarkersOwnErrorAndSigmasAllOfIt) {
  ReportExample example = example_;
  const int marker_id = example.shape.markers.front().marker_id;
  // All corners have the same error, so that the centre has their covariance, and another one that
  // other markers share.
  AdjustmentUncertainty uncertainty;
  Eigen::Matrix3d factor;
  factor << 3e-3, 0, 0, 1e-3, 2e-3, 0, 0.5e-3, 0, 1e-3;
  const Eigen::Matrix3d own = Eigen::Vector3d(4e-6, 1e-6, 9e-6).asDiagonal();
  uncertainty.points.blocks = {own.replicate<4, 4>()};
  uncertainty.points.factor.resize(12, 3);
  uncertainty.points.signs = Eigen::VectorXd::Ones(3);
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    uncertainty.points.point3D_ids.push_back(Point3DIdFromCorner({marker_id, corner}));
    uncertainty.points.factor.middleRows<3>(3 * (corner - 1)) = factor;
  }
  ReportInput input = example.Input();
  input.uncertainty = &uncertainty;
  const json markers = json::parse(ReportJson(input)).at("markers");
  Eigen::Matrix3d axes;
  for (int i = 0; i < 3; ++i) axes.col(i) = VectorOf(markers.at(0).at("ellipsoid").at(i));
  const Eigen::Matrix3d covariance = factor * factor.transpose();
  EXPECT_LT((axes * axes.transpose() - own).norm(), 1e-12);
  EXPECT_NEAR(Number(markers.at(0).at("sigma_mm")), 1e3 * std::sqrt((covariance + own).trace()),
              1e-9);
  EXPECT_FALSE(markers.at(1).contains("ellipsoid"));
}

TEST_F(ReportData, EllipsoidsFollowTheSigmasWhereThereIsNoCovariance) {
  ReportExample example = example_;
  example.shape.markers.front().sigma_m[0] = Eigen::Vector3d(3e-3, 1e-3, 2e-3);
  const json marker = json::parse(ReportJson(example.Input())).at("markers").at(0);
  EXPECT_NEAR(VectorOf(marker.at("ellipsoid").at(2)).cwiseAbs().x(), 3e-3, 1e-12);
  EXPECT_NEAR(VectorOf(marker.at("ellipsoid").at(0)).cwiseAbs().y(), 1e-3, 1e-12);
}

TEST_F(ReportData, MissingMarkersHaveReasons) {
  ReportInput input = example_.Input();
  EXPECT_EQ(Parsed().at("markers_left_out").at(0).at("name"), "8000");
  EXPECT_THAT(Parsed().at("markers_left_out").at(0).at("reason"), HasSubstr("no corner"));
  input.markers_left_out = {{"8000", "seen in one image"}};
  const json left_out = json::parse(ReportJson(input)).at("markers_left_out");
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_EQ(left_out.at(0).at("reason"), "seen in one image");
}

TEST_F(ReportData, ImagesThatAreNotNeededAreNotLeftOut) {
  ReportInput input = example_.Input();
  input.images_left_out = {{"b.jpg", "no marker found"}};
  input.images_not_needed = {{"a.jpg", "others are sharper"}};
  const json data = json::parse(ReportJson(input));
  EXPECT_EQ(data.at("images_left_out"),
            json::parse(R"([{"name": "b.jpg", "reason": "no marker found"}])"));
  EXPECT_EQ(data.at("images_not_needed"),
            json::parse(R"([{"name": "a.jpg", "reason": "others are sharper"}])"));
}

// The program prints the same markers, so it asks for them too.
TEST_F(ReportData, MarkersLeftOutAreTheDroppedAndTheMissing) {
  const auto left_out =
      AllMarkersLeftOut({{"5", "on two places"}}, example_.shape, example_.metrics);
  ASSERT_EQ(left_out.size(), 2u);
  EXPECT_EQ(left_out[0].reason, "on two places");
  EXPECT_EQ(left_out[1].name, "8000");
}

// Small objects keep their digits.
TEST(BoxText, IsInMillimetresBelowAMetre) {
  EXPECT_EQ(BoxText({0.0403, 0.04015, 0.04001}, "x"), "40.30 x 40.15 x 40.01 mm");
  EXPECT_EQ(BoxText({4.914, 3.097, 0.419}, "by"), "4.914 by 3.097 by 0.419 m");
}

// The rejected corners of a marker are not of the shape, and the marker counts as not detected.
TEST_F(ReportData, ThePictureSaysWhatWasRejectedAndNotDetected) {
  ReportExample example = example_;
  EXPECT_TRUE(Parsed().at("picture").at("rejected").empty());
  EXPECT_TRUE(Parsed().at("picture").at("not_detected").empty());
  ModelImage& image = example.model.images.front();
  const Point3DId first = image.points2D.front().point3D_id;
  const int marker_id = CornerFromPoint3DId(first).marker_id;
  std::vector<Eigen::Vector2d> corners_px;
  for (std::size_t i = 0; i < image.points2D.size(); ++i) {
    Point2D& point = image.points2D[i];
    if (CornerFromPoint3DId(point.point3D_id).marker_id != marker_id) continue;
    auto& track = example.model.points3D.at(point.point3D_id).track;
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&](const TrackElement& element) {
                                 return element.image_id == image.image_id &&
                                        element.point2D_idx == i;
                               }),
                track.end());
    corners_px.push_back(point.x_in_image_px);
    point.point3D_id = kInvalidPoint3DId;
  }
  const json picture = json::parse(ReportJson(example.Input())).at("picture");
  ASSERT_EQ(picture.at("rejected").size(), 4u);
  ASSERT_EQ(picture.at("not_detected").size(), 1u);
  EXPECT_EQ(picture.at("not_detected").at(0).at("id"), marker_id);
  for (int i = 0; i < 4; ++i) {
    const json& corner = picture.at("not_detected").at(0).at("corners").at(i);
    const Eigen::Vector2d projected(Number(corner.at(0)), Number(corner.at(1)));
    EXPECT_LT((projected - corners_px[static_cast<std::size_t>(i)]).norm(), 2.0);  // 0.2 px noise
  }
}

TEST_F(ReportData, ThePictureHasEveryCornerOfTheCentralImage) {
  const TempDir dir;
  DrawCentralImage(example_.model, dir.path());
  ReportInput input = example_.Input();
  input.image_path = dir.path().string();
  const json picture = json::parse(ReportJson(input)).at("picture");
  EXPECT_FALSE(picture.contains("problem"));
  EXPECT_GT(picture.at("jpeg").get<std::string>().size(), 1000u);
  const ModelImage& image = example_.model.images.front();
  ASSERT_EQ(picture.at("points").size(), image.points2D.size());
  for (const json& point : picture.at("points")) {
    const Eigen::Vector2d detected(Number(point.at(1)), Number(point.at(2)));
    const Eigen::Vector2d residual(Number(point.at(3)), Number(point.at(4)));
    const auto projected = ImageFromCam(
        example_.model.cameras.at(1),
        image.cam_from_world * example_.model.points3D.at(point.at(0).get<Point3DId>()).x_in_world);
    EXPECT_LT((detected + residual - projected.value()).norm(), 1e-9);
  }
}

TEST_F(ReportData, SaysWhyThereIsNoPicture) {
  EXPECT_THAT(Parsed().at("picture").at("problem"), HasSubstr("folder of the images"));
  ReportInput input = example_.Input();
  input.image_path = "nowhere";
  EXPECT_EQ(json::parse(ReportJson(input)).at("picture").at("problem"), "cannot be read");
}

TEST_F(ReportData, UpAndFrontAreTheCentralCamerasUnlessGiven) {
  const Rigid3& cam_from_world = example_.model.images.front().cam_from_world;
  const json frame = Parsed().at("frame");
  EXPECT_LT((cam_from_world.rotation * VectorOf(frame.at("up")) + Eigen::Vector3d::UnitY()).norm(),
            1e-12);
  EXPECT_LT(
      (cam_from_world.rotation * VectorOf(frame.at("forward")) - Eigen::Vector3d::UnitZ()).norm(),
      1e-12);
  ReportInput input = example_.Input();
  input.frame = {"hull", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()};
  EXPECT_EQ(json::parse(ReportJson(input)).at("frame").at("name"), "hull");
}

TEST_F(ReportData, SectionsAndSurfaceAreThereOnlyWhereGiven) {
  EXPECT_FALSE(Parsed().contains("sections"));
  EXPECT_FALSE(Parsed().contains("section_notes"));
  EXPECT_FALSE(Parsed().contains("surfaces"));
  EXPECT_FALSE(Parsed().contains("rigs"));
  EXPECT_FALSE(Parsed().contains("design"));
  ReportExample example = example_;
  SectionReport& report = example.sail.sections;
  Section section = StraightSection("h1", {0, 0, 1.5}, {2, 0, 1.5});
  section.height_m = 1.5;
  section.chord_m = Estimate{2.0, 0.001};
  section.camber = Estimate{0.1, std::nullopt};
  report.sections = {section, StraightSection("h2", {0, 0, 2.5}, {1, 0, 2.5})};
  report.notes = {"twist of sail refers to section h2"};
  report.rigs.resize(2);
  report.rigs[1].part = "sail";
  report.rigs[1].luff_bend_m = Estimate{0.03, 0.001};
  example.sail.surface_notes = {"jib: too few lines"};
  ReportInput input = example.Input();
  input.design = ReportDesign{"design.step", 30, 12.5, {{{0, 0.01}, {2, 0.01}}, {}}};
  input.clip = ReportClip{25, 4.04};
  const json data = json::parse(ReportJson(input));
  EXPECT_EQ(data.at("sections").at(0).at("chord_sigma_m"), 0.001);
  EXPECT_EQ(data.at("sections").at(0).at("name"), "h1");
  EXPECT_EQ(data.at("sections").at(0).at("profile").back(), json::parse("[2.0, 0.0]"));
  EXPECT_EQ(data.at("sections").at(0).at("profile_in_shape").back(),
            json::parse("[2.0, 0.0, 1.5]"));
  EXPECT_EQ(data.at("sections").at(0).at("design").size(), 2u);
  EXPECT_EQ(data.at("design").at("distance_mm"), 12.5);
  EXPECT_FALSE(data.at("sections").at(1).contains("design"));
  EXPECT_EQ(data.at("sections").at(0).at("camber_percent"), 10.0);
  EXPECT_FALSE(data.at("sections").at(0).contains("camber_sigma_percent"));
  EXPECT_FALSE(data.at("sections").at(0).contains("twist_deg"));
  EXPECT_EQ(data.at("section_notes").at(0), "twist of sail refers to section h2");
  EXPECT_EQ(data.at("surface_notes"), json::parse(R"(["jib: too few lines"])"));
  // A rig of which nothing is known is left out.
  EXPECT_EQ(data.at("rigs"), json::parse(R"([{"part": "sail", "luff_bend_mm": 30.0,
                                              "luff_bend_sigma_mm": 1.0}])"));
  EXPECT_EQ(data.at("origin").at(1), "25 frames/s");
  EXPECT_EQ(data.at("origin").at(2), "4.0 s");
}

TEST_F(ReportData, KnownPointsAreTheRowsOfTheMetrics) {
  ReportInput input = example_.Input();
  KnownPointFit fit;
  input.known_points = &fit;
  EXPECT_FALSE(json::parse(ReportJson(input)).contains("known_points"));
  fit.points.push_back({KnownPoint{12, 3, {1.0, std::nullopt, 2.0}, 0.002, false},
                        PointState::kUsed,
                        {0.001, 0, -0.002},
                        1.5});
  fit.known_from_shape = Rigid3();
  const json rows = json::parse(ReportJson(input)).at("known_points");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].at("point"), "12.3");
  EXPECT_EQ(rows[0].at("dz_mm"), -2.0);
  EXPECT_FALSE(rows[0].contains("dy_mm"));
  EXPECT_EQ(rows[0].at("in_sigmas"), 1.5);
  EXPECT_EQ(rows[0].at("result"), "used");
}

TEST_F(ReportData, CanStandInsideAScript) {
  ReportInput input = example_.Input();
  input.title = "</script><!-- \xff";
  const std::string text = ReportJson(input);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_THAT(json::parse(text).at("title"), HasSubstr("</script><!-- "));
}

TEST_F(ReportData, AModelWithoutImagesIsRefused) {
  ReportExample example = example_;
  example.model.images.clear();
  EXPECT_THROW(ReportJson(example.Input()), DataError);
}

}  // namespace
}  // namespace velamap
