// The smooth surfaces through the parts of a shape. A comparison needs each of them several times,
// and fits take much of its time, so a surface is fitted when it is first asked for and then kept.

#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "exporters/surface/surface.h"
#include "importer/layout/layout.h"

namespace velamap {

// Not thread-safe.
class ShapeSurfaces {
 public:
  explicit ShapeSurfaces(MarkerShape shape);

  const MarkerShape& shape() const { return shape_; }

  // Throw the errors of FitSurface().
  const FittedSurface& Of(const LayoutPart& part) const;
  // Through the markers that `other` has whole as well, so that the surfaces of both have the same
  // parameters.
  const FittedSurface& OfCommon(const LayoutPart& part, const MarkerShape& other) const;

 private:
  const FittedSurface& Fit(const LayoutPart& part, const MarkerShape& markers) const;

  MarkerShape shape_;
  // By the part's name and its whole markers.
  mutable std::map<std::pair<std::string, std::vector<int>>, FittedSurface> fits_;
};

}  // namespace velamap
