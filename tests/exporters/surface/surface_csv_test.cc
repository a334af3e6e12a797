#include "exporters/surface/surface_csv.h"

#include <sstream>

#include <gtest/gtest.h>

#include "exporters/surface/surface.h"

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

TEST(SurfaceCsv, EdgesAsCsv) {
  FittedSurface fitted;
  fitted.edges = {{"luff", {1, 2, 3}, 0.25}, {"luff", {1, 2, 4}, {}}};
  std::ostringstream out;
  WriteSurfaceEdgesCsv(fitted, out);
  EXPECT_EQ(out.str(), "edge,x,y,z,sigma\nluff,1,2,3,0.25\nluff,1,2,4,\n");
}

}  // namespace
}  // namespace velamap
