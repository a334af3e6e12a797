#include "exporters/surface/surface_csv.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

TEST(SurfaceCsv, ResidualsAsCsv) {
  FittedSurface fitted;
  fitted.residuals = {{7, "h,1", 0.25, 0.5, -0.00125, 0, true}, {9, "", 1, 0.5, 0.5, 0.25, false}};
  std::ostringstream out;
  WriteSurfaceResidualsCsv(fitted, out);
  EXPECT_EQ(out.str(),
            "marker_id,line,u,v,distance,beyond_edge,is_used\n"
            "7,\"h,1\",0.25,0.5,-0.00125,0,1\n"
            "9,,1,0.5,0.5,0.25,0\n");
}

TEST(SurfaceCsv, TheRmsOfResidualsIsThatOfTheUsedMarkers) {
  FittedSurface fitted;
  fitted.residuals = {{7, "h,1", 0.25, 0.5, -0.003, 0, true},
                      {8, "h,1", 0.25, 0.5, 0.004, 0, true},
                      {9, "", 1, 0.5, 0.5, 0.25, false}};
  std::stringstream file;
  WriteSurfaceResidualsCsv(fitted, file);
  EXPECT_NEAR(ReadSurfaceResidualRms(file, "r.csv"), 0.005 / std::sqrt(2.0), 1e-12);
  const auto read = [](const std::string& text) {
    std::istringstream in(text);
    return ReadSurfaceResidualRms(in, "r.csv");
  };
  const std::string header = "marker_id,line,u,v,distance,beyond_edge,is_used\n";
  EXPECT_EQ(read(header), 0.0);
  ExpectThrows<InputError>([&] { read("marker_id,distance\n"); },
                           {"r.csv: expected the header marker_id,line"});
  ExpectThrows<InputError>([&] { read(header + "7,h1,0,0,nan,0,1\n"); },
                           {"r.csv:2: column distance", "metres", "'nan'"});
  ExpectThrows<InputError>([&] { read(header + "7,h1,0\n"); }, {"r.csv:2: 3 columns"});
  ExpectThrows<InputError>([] { ReadSurfaceResidualRms("no such file"); }, {"surface_residuals"});
}

TEST(SurfaceCsv, EdgesAsCsv) {
  FittedSurface fitted;
  fitted.edges = {{"luff", {1, 2, 3}, 0.25}, {"luff", {1, 2, 4}, {}}};
  std::ostringstream out;
  WriteSurfaceEdgesCsv(fitted, out);
  EXPECT_EQ(out.str(), "edge,x,y,z,sigma\nluff,1,2,3,0.25\nluff,1,2,4,\n");
}

}  // namespace
}  // namespace velamap
