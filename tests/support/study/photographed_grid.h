// The markers of a clip's first frame as a grid of markers with exact corners.

#pragma once

#include "tests/importer/refine/marker_grid.h"
#include "tests/support/clip/clip_scene.h"
#include "tests/support/render/surface_renderer.h"

namespace velamap {

// Holds the markers that are wholly in the picture, with starts at the true corners.
MarkerGrid PhotographedGrid(const ClipScene& scene, const SurfaceRenderOptions& rendering);

}  // namespace velamap
