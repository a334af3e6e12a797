#include "exporters/report/report_sail.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/exporters/report/report_example.h"

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
  ReportExample example = MakeReportExample(1, 2);
  example.freeform.surfaces = {Tank(1), Tank(1000000)};
  example.freeform.notes = {"tank: closed"};
  ReportJsonValue data;
  AddSail(example.Input(), &data);
  const ReportJsonValue& surfaces = data.at("surfaces");
  ASSERT_EQ(surfaces.size(), 2u);
  for (const ReportJsonValue& surface : surfaces) {
    EXPECT_EQ(surface.at("part"), "tank");
    EXPECT_EQ(surface.at("is_sail"), false);
    EXPECT_EQ(surface.at("area_m2"), 2.0);
    EXPECT_EQ(surface.at("volume_m3"), 0.3);
    EXPECT_DOUBLE_EQ(surface.at("distance_mm"), 0.4);
    EXPECT_DOUBLE_EQ(surface.at("sigma_mm"), 0.6);
  }
  EXPECT_EQ(surfaces[0].at("vertices").size(), 9u);
  EXPECT_EQ(surfaces[0].at("triangles").size(), 3u);
  EXPECT_TRUE(surfaces[1].at("triangles").empty());  // the file would grow beyond what can be sent
  EXPECT_EQ(data.at("surface_notes").size(), 1u);
}

}  // namespace
}  // namespace velamap
