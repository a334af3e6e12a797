#include "workflows/commands/report_design.h"

#include <gtest/gtest.h>

#include "exporters/report/report_sail.h"
#include "exporters/sail/section.h"
#include "importer/base/error.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

// The report of a boat, and what AddDesign() adds to it.
struct DesignExample {
  ShapeExportReport shape;
  Layout layout = BoatLayout();
  SectionOptions section_options;
  DesignOptions options;

  explicit DesignExample(const MarkerShape& markers) {
    shape.shape = markers;
    shape.frame = ChooseFrame(shape.shape, layout, std::nullopt);
    shape.sail.sections = ComputeSections(markers, shape.frame, layout, nullptr, section_options);
    options.path = "folder/design.ply";
  }

  ReportInput With(const TriangleMesh& design) const {
    ReportInput input{shape.metric_model,  layout,     shape.shape, shape.metrics,
                      shape.model_metrics, shape.scale};
    input.sections = MakeReportSections(shape.sail.sections);
    AddDesign(options, MeshDistance(design), shape, layout, section_options, &input);
    return input;
  }
};

TriangleMesh Moved(const Rigid3& b_from_a, TriangleMesh mesh) {
  for (Eigen::Vector3d& x : mesh.vertices_m) x = b_from_a * x;
  return mesh;
}

// Of the design from the measured profile, at the same place along the chord.
double LargestDepthDifference_m(const ReportSection& section) {
  double largest = 0.0;
  for (std::size_t i = 0; i < section.profile_m.size(); ++i) {
    largest = std::max(largest, std::abs(section.design_m[i].y() - section.profile_m[i].y()));
  }
  return largest;
}

TEST(ReportDesign, OfTheSameShapeCoversItsSections) {
  const DesignExample example(BoatShape());
  const ReportInput input = example.With(Moved(FarPose(), SailMesh()));
  ASSERT_TRUE(input.design);
  EXPECT_EQ(input.design->name, "design.ply");
  EXPECT_EQ(input.design->num_markers, 30);  // of the sail: the hull is no part of its design
  EXPECT_LT(input.design->distance_mm, 1.0);
  ASSERT_EQ(input.sections.size(), 5u);
  for (const ReportSection& section : input.sections) {
    ASSERT_EQ(section.design_m.size(), section.profile_m.size()) << section.name;
    EXPECT_LT(LargestDepthDifference_m(section), 1e-3) << section.name;
  }
}

TEST(ReportDesign, ShowsWhereAMeasuredLineIsFuller) {
  MarkerShape fuller = BoatShape();
  fuller = Shifted({33, 34}, {0, 0.03, 0}, fuller);  // the middle of h3, to leeward
  const ReportInput input = DesignExample(fuller).With(SailMesh());
  for (const ReportSection& section : input.sections) {
    const double difference_m = LargestDepthDifference_m(section);
    if (section.name == "h3") {
      EXPECT_NEAR(difference_m, 0.03, 0.01);
    } else {
      EXPECT_LT(difference_m, 0.01) << section.name;
    }
  }
}

TEST(ReportDesign, InAnotherUnitIsLeftOut) {
  TriangleMesh design = SailMesh();
  for (Eigen::Vector3d& x : design.vertices_m) x *= 1e3;
  const ReportInput input = DesignExample(BoatShape()).With(design);
  EXPECT_FALSE(input.design);
  for (const ReportSection& section : input.sections) EXPECT_TRUE(section.design_m.empty());
}

TEST(ReportDesign, IsNoTable) {
  DesignOptions options;
  EXPECT_EQ(ReadDesign(options), nullptr);
  options.path = "design.csv";
  ExpectThrows<InputError>([&] { CheckDesign(options, {}); }, {"--design_path", "design.csv"});
}

}  // namespace
}  // namespace velamap
