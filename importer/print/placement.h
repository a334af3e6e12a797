// Where markers go on a sail, a wall or a hull, and the layout that follows from it.
//
// Surface frame: the surface laid flat, x right, y up, mm. The origin is the tack of a sail, whose
// luff runs along y; or the centre of the first marker of a grid.

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
  int markers_per_line = 12;  // fewer near the head, where they have no room
  int hull_markers = 0;       // of a hull that goes with the sail

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(SailPlacementOptions* options);

struct MarkerPlace {
  int marker_id = 0;
  Eigen::Vector2d center_mm = Eigen::Vector2d::Zero();
  double along_mm = 0.0;  // of the centre, from the luff or the grid's first marker along the line
};

struct PlacedLine {
  std::string name;
  std::vector<MarkerPlace> markers;
  // On a sail: where the line meets the luff, from the tack, and the leech, from the clew.
  double luff_mm = 0.0, leech_mm = 0.0;
};

struct Placement {
  std::string part;
  double length_mm = 0.0;                // of a marker
  double sticker_mm = 0.0;               // width of the sticker
  std::vector<Eigen::Vector2d> sail_mm;  // tack, clew, head; empty for a grid
  std::vector<PlacedLine> horizontal;    // foot to head, each from luff to leech
  std::vector<MarkerLine> vertical;      // foot to head
  // The edges of a sail that PlaceOnSail() covered, to the mm. The head ends where the sail is a
  // sticker wide.
  ClothEdges edges{};
};

// Lines parallel to the foot at equal distances, as low and as high as the stickers have room for;
// the markers of a line at equal distances, the first as near to the luff and the last as near to
// the leech as they have room for. The first and the last markers form vertical lines, and so do
// the markers between them as long as lines hold the same number. Ids count from foot to head, each
// line from luff to leech. Throws InputError, naming the option, for lengths that make no triangle
// and for a sail without room for the lines.
Placement PlaceOnSail(const SailPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id);

// The horizontal lines of the first part of `layout` that has any: at heights as above, the markers
// of each at equal distances. Throws InputError where PlaceOnSail() does, for a layout without
// horizontal lines, and for a line that has no room for its markers.
Placement PlaceLinesOnSail(const SailPlacementOptions& options, const Layout& layout,
                           double sticker_mm);

// Rows from below, each from the left. Throws InputError for a spacing at which stickers overlap.
Placement PlaceOnGrid(const GridPlacementOptions& options, double length_mm, double sticker_mm,
                      int first_id);

LayoutPart PartOfPlacement(const Placement& placement);

// A rigid part without lines.
LayoutPart RigidPart(const std::string& name, int first_id, int num_markers);

}  // namespace velamap
