#include "exporters/report/report_sail.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace velamap {
namespace {

PartSurface Tank(std::size_t num_triangles) {
  PartSurface part;
  part.part = "tank";
  FreeformSurface& surface = part.surface;
  surface.area_m2 = 2.0;
  surface.volume_m3 = 0.3;
  surface.distance_m.rms = 0.0004;
  surface.rms_sigma_m = 0.0006;
  surface.mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  surface.mesh.triangles.assign(num_triangles, {{0, 1, 2}});
  return part;
}

TEST(ReportSail, PartsWithoutLinesAreListedAndDrawn) {
  FreeformShape freeform;
  freeform.surfaces = {Tank(1), Tank(1000000)};
  const std::vector<ReportSurface> surfaces = MakeReportSurfaces({}, freeform);
  ASSERT_EQ(surfaces.size(), 2u);
  for (const ReportSurface& surface : surfaces) {
    EXPECT_EQ(surface.part, "tank");
    EXPECT_FALSE(surface.is_sail);
    EXPECT_EQ(surface.area_m2, 2.0);
    EXPECT_EQ(surface.volume_m3, 0.3);
    EXPECT_DOUBLE_EQ(surface.distance_mm, 0.4);
    EXPECT_DOUBLE_EQ(surface.sigma_mm.value(), 0.6);
  }
  EXPECT_EQ(surfaces[0].triangles.size(), 1u);
  EXPECT_EQ(surfaces[0].x_in_shape_m.size(), 3u);
  EXPECT_TRUE(surfaces[1].triangles.empty());  // the file would grow beyond what can be sent around
}

TEST(ReportSail, RigsAboutWhichNothingIsKnownAreLeftOut) {
  SectionReport sections;
  sections.rigs.resize(3);
  sections.rigs[1].part = "main";
  sections.rigs[1].luff_bend_m = Estimate{0.03, 0.001};
  sections.rigs[1].luff_sag_m = Estimate{0.01, std::nullopt};
  sections.rigs[2].part = "jib";
  sections.rigs[2].sheeting_angle_deg = Estimate{8.0, 0.1};
  const std::vector<RigNumbers> rigs = MakeReportRigs(sections);
  ASSERT_EQ(rigs.size(), 2u);
  EXPECT_EQ(rigs[0].part, "main");
  EXPECT_EQ(rigs[0].luff_bend_m->sigma, 0.001);
  EXPECT_FALSE(rigs[0].luff_sag_m->sigma);
  EXPECT_FALSE(rigs[0].sheeting_angle_deg);
  EXPECT_EQ(rigs[1].sheeting_angle_deg->value, 8.0);
}

}  // namespace
}  // namespace velamap
