// Random sails as the evidence of the layout sees them: markers with places and numbers of images,
// on lines that are cambered, twisted, rolled up, uneven, gappy or torn.

#pragma once

#include <random>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/evidence/layout_evidence.h"

namespace velamap {

struct RandomSail {
  Layout layout;
  std::vector<PlacedMarker> markers;  // by ascending id, all where they belong
  double step_m = 0.0;                // mean distance of neighbours along the cloth

  PlacedMarker* Find(int marker_id);
  int NumOnLine(const MarkerLine& line);
};

// kTornAtTimes: one of five sails is torn in its lowest line, where two markers or more are left on
// both sides.
enum class Cloth { kWhole, kTornAtTimes };

RandomSail DrawSail(Cloth cloth, std::mt19937* generator);

// Whether few images that should show the marker do.
enum class Seen { kSeldom, kOften };

// Moves a marker of a line with at least `min_on_line` markers by `num_steps` steps in a random
// direction, and says how often it is seen. Returns its id; -1 where no line has as many.
int MoveOne(int min_on_line, double num_steps, Seen seen, RandomSail* sail,
            std::mt19937* generator);

}  // namespace velamap
