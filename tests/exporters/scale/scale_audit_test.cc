#include "exporters/scale/scale_audit.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "exporters/scale/metric_shape.h"
#include "reconstruct/geometry/marker_pose.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Markers of 100 mm in a row, `per_part` on each of three parts.
Layout RowLayout(int per_part) {
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  for (const char* name : {"a", "b", "c"}) {
    LayoutPart part;
    part.name = name;
    for (int i = 0; i < per_part; ++i) {
      part.marker_ids.push_back(static_cast<int>(layout.parts.size()) * per_part + i);
    }
    layout.parts.push_back(part);
  }
  return layout;
}

// Scatters the sides by the fraction `scatter`.
MarkerShape RowShape(const Layout& layout, double scatter, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, scatter);
  MarkerShape shape;
  for (const int id : MarkerIds(layout)) {
    const double length_m = MarkerLength(layout, id) * (1 + normal(random));
    shape.markers.push_back(
        SquareMarker(id, length_m, {Eigen::Quaterniond::Identity(), {0.3 * id, 0, 0}}));
    shape.markers.back().part = PartOfMarker(layout, id);
  }
  return shape;
}

void Stretch(const Eigen::Vector3d& factors, ShapeMarker* marker) {
  const Eigen::Vector3d center = *marker->x_in_shape_m[0];
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    Eigen::Vector3d& x = *marker->x_in_shape_m[corner];
    x = center + factors.cwiseProduct(x - center);
  }
}

void Resize(double factor, ShapeMarker* marker) {
  Stretch(Eigen::Vector3d::Constant(factor), marker);
}

std::vector<int> Disagreeing(const ScaleAudit& audit) {
  std::vector<int> ids;
  for (const MarkerScale& marker : audit.markers) {
    if (marker.Disagrees()) ids.push_back(marker.marker_id);
  }
  return ids;
}

TEST(ScaleAudit, OfAnExactShapeFindsNothing) {
  const Layout layout = RowLayout(10);
  const ScaleAudit audit = AuditScale(RowShape(layout, 0.0), layout);
  EXPECT_NEAR(audit.deviation, 0.0, 1e-12);
  EXPECT_LT(audit.marker_spread, 1e-8);
  EXPECT_NEAR(*audit.x_over_y, 1.0, 1e-12);
  EXPECT_THAT(Disagreeing(audit), IsEmpty());
  for (const GroupScale& part : audit.parts) EXPECT_NEAR(part.deviation, 0.0, 1e-12);
  EXPECT_EQ(audit.histogram.size(), 1u);
}

TEST(ScaleAudit, AFrameChangesNothing) {
  Model model = ExampleModel();
  AddImageNoise(0.3, 4, &model);
  std::mt19937 random(2);
  for (auto& [id, point] : model.points3D) {
    for (double& x : point.x_in_world) x += 1e-4 * (random() / 4294967295.0 - 0.5);
  }
  const MarkerShape shape = ShapeFromModel(model, ExampleLayout());
  const ScaleAudit expected = AuditScale(shape, ExampleLayout(), &model);
  Model moved = model;  // the model may have any scale, the shape any frame
  TransformModel(ExampleSim3(7.0), &moved);
  const ScaleAudit audit = AuditScale(shape, ExampleLayout(), &moved);
  ASSERT_EQ(audit.markers.size(), expected.markers.size());
  for (std::size_t i = 0; i < audit.markers.size(); ++i) {
    EXPECT_NEAR(audit.markers[i].deviation, expected.markers[i].deviation, 1e-9);
    EXPECT_NEAR(*audit.markers[i].sigma / *expected.markers[i].sigma, 1.0, 1e-4);
  }
  EXPECT_NEAR(*audit.x_over_y, *expected.x_over_y, 1e-9);
  EXPECT_GT(expected.marker_spread + *expected.markers[0].sigma, 1e-5);
}

TEST(ScaleAudit, MarkersOfAnotherSizeAreNamed) {
  const Layout layout = RowLayout(10);
  MarkerShape shape = RowShape(layout, 1e-3);
  Resize(0.5, &shape.markers[4]);    // a wrong size in the layout
  Resize(1.02, &shape.markers[17]);  // a bad print
  const ScaleAudit audit = AuditScale(shape, layout);
  EXPECT_THAT(Disagreeing(audit), ElementsAre(4, 17));
  EXPECT_NEAR(audit.markers[4].deviation, 1.0, 0.02);  // alone it would give twice the scale
  EXPECT_NEAR(audit.markers[17].deviation, -0.02, 0.01);
  EXPECT_LT(std::abs(audit.deviation), 1e-3);
  EXPECT_NEAR(audit.marker_spread, 1e-3, 5e-4);
}

// A marker does not disagree if the noise of its image points explains its deviation.
TEST(ScaleAudit, NoiseIsNoDisagreement) {
  Model model = ExampleModel();
  const ScaleAudit exact =
      AuditScale(ShapeFromModel(model, ExampleLayout()), ExampleLayout(), &model);
  EXPECT_LT(*exact.markers[2].sigma, 1e-9);
  AddImageNoise(0.5, 4, &model);
  const ScaleAudit noisy =
      AuditScale(ShapeFromModel(model, ExampleLayout()), ExampleLayout(), &model);
  EXPECT_GT(*noisy.markers[2].sigma, 1e-3);
  Model one_off = model;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Eigen::Vector3d x1 = model.points3D.at(31).x_in_world;
    Eigen::Vector3d& x = one_off.points3D.at(Point3DIdFromCorner({3, corner})).x_in_world;
    x = x1 + (1 + *noisy.markers[2].sigma) * (x - x1);
  }
  const MarkerShape shape = ShapeFromModel(one_off, ExampleLayout());
  EXPECT_THAT(Disagreeing(AuditScale(shape, ExampleLayout())), ElementsAre(3));
  EXPECT_THAT(Disagreeing(AuditScale(shape, ExampleLayout(), &one_off)), IsEmpty());
}

TEST(ScaleAudit, AScaleErrorOfOnePartShowsWithoutThatPart) {
  const Layout layout = RowLayout(12);
  MarkerShape shape = RowShape(layout, 1e-3);
  for (ShapeMarker& marker : shape.markers) {
    if (marker.part == "b") Resize(1 / 1.01, &marker);
  }
  const ScaleAudit audit = AuditScale(shape, layout);
  ASSERT_EQ(audit.parts.size(), 3u);
  EXPECT_EQ(audit.parts[1].part, "b");
  EXPECT_EQ(audit.parts[1].num_markers, 12);
  EXPECT_NEAR(audit.parts[1].deviation, 0.01, 0.002);
  EXPECT_GT(audit.parts[1].deviation, 2 * *audit.parts[1].sigma);
  EXPECT_LT(std::abs(audit.parts[0].deviation), 0.007);
}

TEST(ScaleAudit, MarkersOfPartsThatDisagreeAreComparedWithTheirPart) {
  const Layout layout = RowLayout(12);
  MarkerShape shape = RowShape(layout, 1e-3);
  EXPECT_FALSE(AuditScale(shape, layout).parts_disagree);
  for (ShapeMarker& marker : shape.markers) {
    if (marker.part == "b") Resize(1 / 1.01, &marker);
  }
  Resize(1.02, &shape.markers[14]);
  const ScaleAudit audit = AuditScale(shape, layout);
  EXPECT_TRUE(audit.parts_disagree);
  EXPECT_THAT(Disagreeing(audit), ElementsAre(14));
  EXPECT_LT(audit.marker_spread, 2e-3);
  EXPECT_LT(*audit.parts[1].sigma, 1e-3);
}

TEST(ScaleAudit, PartsThatAgreeLieWithinTheirSigmas) {
  const Layout layout = RowLayout(12);
  int num_within = 0, num_parts = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    for (const GroupScale& part : AuditScale(RowShape(layout, 2e-3, seed), layout).parts) {
      if (std::abs(part.deviation) < *part.sigma) ++num_within;
      ++num_parts;
    }
  }
  EXPECT_NEAR(num_within / static_cast<double>(num_parts), 0.67, 0.08);
}

TEST(ScaleAudit, AWrongSizeClassShowsInTheSizes) {
  Layout layout = RowLayout(10);
  for (int id = 0; id < 30; id += 2) layout.marker_lengths_m[id] = 0.05;
  MarkerShape shape = RowShape(layout, 1e-3);
  EXPECT_LT(std::abs(AuditScale(shape, layout).sizes.at(0).deviation), 1.5e-3);
  for (int id = 0; id < 30; id += 2) layout.marker_lengths_m[id] = 0.0505;
  const ScaleAudit audit = AuditScale(shape, layout);
  ASSERT_EQ(audit.sizes.size(), 2u);
  EXPECT_EQ(audit.sizes[0].length_m, 0.0505);
  EXPECT_NEAR(audit.sizes[0].deviation, 0.01, 0.002);
  EXPECT_EQ(AuditScale(RowShape(RowLayout(4), 0.0), RowLayout(4)).sizes.size(), 0u);
}

TEST(ScaleAudit, APrintThatIsNotSquareShowsInXOverY) {
  const Layout layout = RowLayout(10);
  MarkerShape shape = RowShape(layout, 1e-3);
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 1e-4);
  for (ShapeMarker& marker : shape.markers) {
    Stretch({1.004 * (1 + noise(random)), 1.0, 1.0}, &marker);
  }
  const ScaleAudit audit = AuditScale(shape, layout);
  EXPECT_NEAR(*audit.x_over_y, 1.004, 1e-4);
  EXPECT_LT(*audit.x_over_y_sigma, 5e-5);
  EXPECT_GT(*audit.x_over_y_sigma, 5e-6);
}

TEST(ScaleAudit, TheHistogramHoldsEveryMarkerOnce) {
  const Layout layout = RowLayout(40);
  MarkerShape shape = RowShape(layout, 1e-3);
  Resize(3.0, &shape.markers[4]);
  Resize(0.3, &shape.markers[5]);
  const ScaleAudit audit = AuditScale(shape, layout);
  int num_markers = 0;
  for (const HistogramBin& bin : audit.histogram) num_markers += bin.num_markers;
  EXPECT_EQ(num_markers, 120);
  EXPECT_GE(audit.histogram.size(), 8u);
  EXPECT_LE(audit.histogram.size(), 21u);
  for (std::size_t i = 0; i < audit.histogram.size(); ++i) {
    const HistogramBin& bin = audit.histogram[i];
    EXPECT_LT(bin.from, bin.to);
    EXPECT_EQ(bin.from, i > 0 ? audit.histogram[i - 1].to : bin.from);
    int expected = 0;
    for (const MarkerScale& marker : audit.markers) {
      const bool is_last = i + 1 == audit.histogram.size();
      expected += marker.deviation >= bin.from &&
                  (marker.deviation < bin.to || (is_last && marker.deviation == bin.to));
    }
    EXPECT_EQ(bin.num_markers, expected) << i;
  }
}

// The blind spot of all figures from sides: only a tape measure shows that all markers shrank.
TEST(ScaleAudit, AnErrorOfAllMarkersShowsInKnownDistancesOnly) {
  Layout layout = RowLayout(10);
  layout.distances = {{0, 0, 29, 0, 0.3 * 29, 1e-3, false},
                      {0, 0, 10, 0, 3.0, 1e-3, false},
                      {0, 0, 20, 0, 6.0, 1e-3, true}};
  MarkerShape shape = RowShape(layout, 1e-4);
  for (ShapeMarker& marker : shape.markers) {
    for (auto& x : marker.x_in_shape_m) x->x() += 0.01 * 0.3 * marker.marker_id;
  }
  const ScaleAudit audit = AuditScale(shape, layout);
  EXPECT_LT(std::abs(audit.deviation), 1e-4);
  EXPECT_NEAR(*audit.distance_deviation, 0.01, 1e-4);
  // Without an adjustment that uses it, a scale bar is a check as the others.
  EXPECT_NEAR(*audit.distance_deviation_sigma, 1e-3 / std::hypot(8.7, 3.0, 6.0), 2e-5);
  EXPECT_FALSE(AuditScale(shape, RowLayout(10)).distance_deviation.has_value());
}

// An adjustment with known sizes pulls every marker to its printed size; the audit still shows the
// sizes in the images.
TEST(ScaleAudit, WithAnUncertaintyTheImagesAreAsked) {
  Model model = ExampleModel();
  Layout layout = ExampleLayout();
  layout.marker_lengths_m[4] = 0.102;  // wrong
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const Eigen::Vector3d x1 = ExampleModel().points3D.at(41).x_in_world;
    Eigen::Vector3d& x = model.points3D.at(Point3DIdFromCorner({4, corner})).x_in_world;
    x = x1 + 1.02 * (x - x1);
  }
  const MarkerShape shape = ShapeFromModel(model, layout);
  EXPECT_THAT(Disagreeing(AuditScale(shape, layout, &model)), IsEmpty());
  AdjustmentUncertainty uncertainty = ExampleUncertainty(model);
  uncertainty.apparent_inset_sigma_px = 0.01;
  const ScaleAudit audit = AuditScale(shape, layout, &model, &uncertainty);
  EXPECT_THAT(Disagreeing(audit), ElementsAre(4));
  EXPECT_NEAR(audit.markers[3].deviation, 0.02, 1e-3);
  EXPECT_EQ(audit.apparent_inset_px->sigma, 0.01);
}

// Markers of 100 mm around a cylinder with a radius of 250 mm, in the images of ExampleModel().
Model BentModel() {
  constexpr double kRadius_m = 0.25;
  constexpr int kColumns = 4, kRows = 3;
  Model model = ExampleModel();
  model.points3D.clear();
  for (ModelImage& image : model.images) image.points2D.clear();
  for (int marker_id = 0; marker_id < kColumns * kRows; ++marker_id) {
    const Eigen::Vector3d middle_m(0.14 * (marker_id % kColumns - 1.5),
                                   0.14 * (marker_id / kColumns - 1), 0);
    int corner = 0;
    for (const Eigen::Vector3d& x_in_marker : CornersInMarker(0.1)) {
      const Eigen::Vector3d flat_m = middle_m + x_in_marker;
      const double angle = flat_m.x() / kRadius_m;
      const Point3DId id = Point3DIdFromCorner({marker_id, ++corner});
      Point3D& point = model.points3D[id];
      point.x_in_world = {kRadius_m * std::sin(angle), flat_m.y(),
                          kRadius_m * (std::cos(angle) - 1)};
      for (ModelImage& image : model.images) {
        const auto x_px = ImageFromCam(model.cameras.at(image.camera_id),
                                       image.cam_from_world * point.x_in_world);
        point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
        image.points2D.push_back({x_px.value(), id});
      }
    }
  }
  return model;
}

// Their horizontal sides are 0.67 % shorter than printed.
TEST(ScaleAudit, BentMarkersHaveTheirSizeAlongTheBend) {
  const Model model = BentModel();
  const Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  const MarkerShape shape = ShapeFromModel(model, layout);
  AdjustmentUncertainty uncertainty = ExampleUncertainty(model);
  uncertainty.apparent_inset_px = 0.0;
  const ScaleAudit stiff = AuditScale(shape, layout, &model, &uncertainty);
  EXPECT_NEAR(stiff.deviation, 0.0033, 3e-4);
  EXPECT_FALSE(stiff.markers_bend);
  uncertainty.markers_bend = true;
  const ScaleAudit bent = AuditScale(shape, layout, &model, &uncertainty);
  EXPECT_NEAR(bent.deviation, 0.0, 3e-4);
  EXPECT_NEAR(*bent.x_over_y, 1.0, 6e-4);
  EXPECT_TRUE(bent.markers_bend);
}

TEST(ScaleAudit, ASpreadOfThePrintIsFoundInTheShape) {
  Layout layout = RowLayout(10);
  for (int id = 0; id < 30; id += 2) layout.marker_lengths_m[id] = 0.02;
  MarkerShape shape = RowShape(layout, 2e-4);
  for (ShapeMarker& marker : shape.markers) {  // 15 um a side
    Resize(1 + 30e-6 / MarkerLength(layout, marker.marker_id), &marker);
  }
  const PrintSpread spread = AuditScale(shape, layout).spread;
  ASSERT_TRUE(spread.print_um.has_value());
  EXPECT_NEAR(spread.print_um->value, 15, 3 * spread.print_um->sigma);
  EXPECT_LT(spread.print_um->sigma, 2.0);
}

TEST(ScaleAudit, WithoutWholeMarkersThereIsNothingToAudit) {
  const ScaleAudit audit = AuditScale(MarkerShape(), RowLayout(3));
  EXPECT_TRUE(audit.markers.empty());
  EXPECT_TRUE(audit.histogram.empty());
  EXPECT_FALSE(audit.x_over_y.has_value());
}

}  // namespace
}  // namespace velamap
