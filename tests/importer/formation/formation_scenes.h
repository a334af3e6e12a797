// Markers of random cameras, for tests of the image formation.

#pragma once

#include <random>
#include <vector>

#include "importer/formation/fitted_sample.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {

// A grid of markers seen by a camera and printed with margins that are drawn at random over what
// cameras and scissors do.
MarkerGridOptions DrawScene(std::mt19937* random);

std::vector<FormationSample> Samples(const MarkerGrid& grid);

// Mean error of the side in px.
double SideBias(const MarkerGrid& grid, const ImageFormation& formation, double side_mm = 100.0);

}  // namespace velamap
