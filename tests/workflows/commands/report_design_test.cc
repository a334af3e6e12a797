#include "workflows/commands/report_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/cloth/cloth_places.h"
#include "exporters/sail/section.h"
#include "importer/base/error.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/support/error_matchers.h"
#include "workflows/run/report_input.h"

namespace velamap {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Lt;

// The report of a boat, and what AddDesign() adds to it.
struct DesignExample {
  ShapeExportReport shape;
  Layout layout = BoatLayout();
  SectionOptions section_options;
  DesignOptions options;

  explicit DesignExample(const MarkerShape& markers) {
    shape.shape = markers;
    shape.frame = ChooseFrame(shape.shape, layout, std::nullopt);
    MarkerShape on_cloth = markers;
    MoveCenters(OffsetsToCloth(markers, layout, shape.frame.up_in_frame), &on_cloth);
    shape.sail.sections = ComputeSections(on_cloth, shape.frame, layout, nullptr, section_options);
    options.path = "folder/design.ply";
  }

  ReportInput With(const TriangleMesh& design) const {
    ReportInput input = MakeReportInput(shape, layout, {});
    AddDesign(options, MeshDistance(design), shape, layout, section_options, &input);
    return input;
  }
};

TriangleMesh Moved(const Rigid3& b_from_a, TriangleMesh mesh) {
  for (Eigen::Vector3d& x : mesh.vertices_m) x = b_from_a * x;
  return mesh;
}

// Of the design from the measured profile of each section, at the same place along the chord.
std::vector<double> LargestDepthDifferences_m(const ReportInput& input) {
  std::vector<double> differences;
  for (const Section& section : input.sail.sections.sections) {
    const auto& design_m = input.design->profiles_m[differences.size()];
    const auto measured = SampleProfile(section, static_cast<int>(design_m.size()));
    double& largest = differences.emplace_back(0.0);
    for (std::size_t i = 0; i < design_m.size(); ++i) {
      largest = std::max(largest, std::abs(design_m[i].y() - measured[i].depth_m));
    }
  }
  return differences;
}

TEST(ReportDesign, OfTheSameShapeCoversItsSections) {
  const DesignExample example(BoatShape());
  const ReportInput input = example.With(Moved(FarPose(), SailMesh()));
  ASSERT_TRUE(input.design);
  EXPECT_EQ(input.design->name, "design.ply");
  EXPECT_EQ(input.design->num_markers, 30);  // of the sail: the hull is no part of its design
  EXPECT_LT(input.design->distance_mm, 1.0);
  ASSERT_EQ(input.design->profiles_m.size(), 5u);
  for (const auto& profile_m : input.design->profiles_m) EXPECT_EQ(profile_m.size(), 101u);
  EXPECT_THAT(LargestDepthDifferences_m(input), Each(Lt(1e-3)));
}

TEST(ReportDesign, ShowsWhereAMeasuredLineIsFuller) {
  MarkerShape fuller = BoatShape();
  fuller = Shifted({33, 34}, {0, 0.03, 0}, fuller);  // the middle of h3, to leeward
  const DesignExample example(fuller);
  const ReportInput input = example.With(SailMesh());
  EXPECT_THAT(LargestDepthDifferences_m(input),
              ElementsAre(Lt(0.01), Lt(0.01), DoubleNear(0.03, 0.01), Lt(0.01), Lt(0.01)));
}

TEST(ReportDesign, InAnotherUnitIsLeftOut) {
  TriangleMesh design = SailMesh();
  for (Eigen::Vector3d& x : design.vertices_m) x *= 1e3;
  const DesignExample example(BoatShape());
  EXPECT_FALSE(example.With(design).design);
}

TEST(ReportDesign, IsNoTable) {
  DesignOptions options;
  EXPECT_EQ(ReadDesign(options), nullptr);
  options.path = "design.csv";
  ExpectThrows<InputError>([&] { CheckDesign(options, {}); }, {"--design_path", "design.csv"});
}

}  // namespace
}  // namespace velamap
