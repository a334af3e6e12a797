// Reads known_points.

#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/layout/layout_items.h"

namespace velamap {
namespace {

// Larger than any coordinate of a national grid.
constexpr double kMaxCoordinate_m = 1e8;
// No point of a marker is measured less accurately than the maximum, which a sigma that was given
// in mm by mistake usually exceeds.
constexpr double kMinSigma_m = 1e-6, kMaxSigma_m = 1.0;

double ReadCoordinate(const YamlItem& item) {
  const double x_m = ReadMetres(item);
  if (!(std::abs(x_m) <= kMaxCoordinate_m)) {
    item.Fail(fmt::format("{} m is out of range; give a coordinate from -{:g} to {:g} m", x_m,
                          kMaxCoordinate_m, kMaxCoordinate_m));
  }
  return x_m;
}

double ReadSigma(const YamlItem& item) {
  const double sigma_m = ReadMetres(item);
  if (!(sigma_m >= kMinSigma_m && sigma_m <= kMaxSigma_m)) {
    item.Fail(fmt::format("{} m is out of range; give one standard deviation from {:g} to {:g} m",
                          sigma_m, kMinSigma_m, kMaxSigma_m));
  }
  return sigma_m;
}

KnownPoint ReadKnownPoint(const YamlItem& item) {
  KnownPoint point;
  KeyHandlers handlers = {
      {"at", [&](const YamlItem& v) { ReadMarkerPoint(v, &point.marker_id, &point.corner); }},
      {"sigma", [&](const YamlItem& v) { point.sigma_m = ReadSigma(v); }},
      {"use", [&](const YamlItem& v) {
         point.is_check = !TakesPart(v, "frame", "takes part in the frame of the result");
       }}};
  for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
    handlers[kAxisNames[axis]] = [&point, axis](const YamlItem& v) {
      point.x_m[axis] = ReadCoordinate(v);
    };
  }
  constexpr char kExample[] = "{at: 12, x: 2.4, y: 0.1, z: 1.3, sigma: 0.002} (m)";
  ReadMap(item, handlers, {"at", "sigma"}, kExample);
  if (point.NumCoordinates() == 0) {
    item.Fail(
        fmt::format("no coordinate is given; expected x, y, z or some of them, like {}", kExample));
  }
  return point;
}

}  // namespace

std::vector<KnownPoint> ReadKnownPoints(const YamlItem& list, const Layout& layout) {
  std::vector<KnownPoint> points;
  std::set<std::pair<int, int>> seen;
  ForEachElement(list, [&](const YamlItem& item) {
    const KnownPoint point = ReadKnownPoint(item);
    CheckMarkersAreNamed({point.marker_id}, layout, item);
    if (!seen.emplace(point.marker_id, point.corner).second) {
      item.Fail(fmt::format("point {} is given twice; give it once, with all its coordinates",
                            PointName(point.marker_id, point.corner)));
    }
    points.push_back(point);
  });
  if (points.empty()) list.Fail("no point is given; leave the key out");
  return points;
}

}  // namespace velamap
