// Plans where the markers go on a sail, a wall or a hull, and makes the layout for these places.
//
// Surface frame: the surface laid flat, x right, y up, mm. The origin is the tack of a sail, whose
// luff is along y, or the centre of the first marker of a grid.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/option.h"
#include "importer/layout/layout.h"

namespace velamap {

struct GridPlacementOptions {
  int num_rows = 5;
  int num_columns = 7;
  std::optional<double> spacing_m;  // between the centres of neighbours

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(GridPlacementOptions* options);

struct SailPlacementOptions {
  std::optional<double> luff_m, foot_m, leech_m;
  int num_lines = 7;          // horizontal ones
  int markers_per_line = 12;  // at most; near the head there is room for fewer
  int hull_markers = 0;       // on the hull; also used with a grid and for a hull alone

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(SailPlacementOptions* options);

struct MarkerPlace {
  int marker_id = 0;
  Eigen::Vector2d center_mm = Eigen::Vector2d::Zero();
  double along_mm = 0.0;  // of the centre along the line, from the luff or the line's first marker
};

struct PlacedLine {
  std::string name;
  std::vector<MarkerPlace> markers;
  // On a sail: where the line meets the luff, as a distance from the tack, and the leech, as a
  // distance from the clew.
  double luff_mm = 0.0, leech_mm = 0.0;
};

struct Placement {
  std::string part;
  double length_mm = 0.0;                // side of a marker
  double sticker_mm = 0.0;               // longer side of a sticker
  std::vector<Eigen::Vector2d> sail_mm;  // tack, clew, head; empty for a grid
  std::vector<PlacedLine> horizontal;    // foot to head, each from luff to leech
  std::vector<MarkerLine> vertical;      // foot to head
  // The edges of the cloth for the layout, rounded to 1 mm; unknown unless PlaceOnSail() made the
  // placement. The edge at the head is where the sail is as wide as a sticker.
  ClothEdges edges{};
};

// Places horizontal lines parallel to the foot at equal distances, from the lowest to the highest
// place that has room for the stickers. The markers of a line are evenly spaced, the first as near
// to the luff and the last as near to the leech as the stickers allow. The first markers of the
// lines form a vertical line, and so do the last ones; the markers in between do so over
// consecutive lines with the same number of markers. Ids count from foot to head, and on each line
// from luff to leech. Throws InputError, naming the option, if a length is missing, if the lengths
// do not form a triangle, and if the sail has no room for the lines.
Placement PlaceOnSail(const SailPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id);

// Places the horizontal lines of the first part of `layout` that has any, spaced like those of
// PlaceOnSail(). Throws InputError as PlaceOnSail() does, for a layout without horizontal lines,
// and for a line without room for its markers.
Placement PlaceLinesOnSail(const SailPlacementOptions& options, const Layout& layout,
                           double sticker_mm);

// Ids count from the lowest row up, and in each row from the left. Without a spacing, the centres
// are two marker sides apart. Throws InputError for a spacing at which stickers overlap.
Placement PlaceOnGrid(const GridPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id);

LayoutPart PartOfPlacement(const Placement& placement);

// A rigid part without lines.
LayoutPart RigidPart(const std::string& name, int first_id, int num_markers);

}  // namespace velamap
