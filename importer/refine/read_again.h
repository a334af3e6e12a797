// Reads a marker's code a second time, from the fit of the whole marker. If codes differ in few
// cells, as those of 3x3 cells do, blur and an outline that is a pixel off make the search mistake
// one code for another.

#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/dictionary.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/known_marker.h"
#include "importer/pattern/refined_corners.h"

namespace velamap {

// A marker with its id after the second reading. Both its found and its refined corners are
// numbered for that id; there are no refined ones where no fit succeeds.
struct ReadMarker {
  MarkerQuad quad;
  std::optional<RefinedCorners> refined;
};

// What is known of a marker with this id at this place; the other arguments as in RefineMarkers().
KnownMarker KnownMarkerAt(const MarkerQuad& quad, const Dictionary& dictionary, int border_bits,
                          const std::vector<double>& sides_mm, const Camera* camera);

// `gray`: 8-bit, with dark markers on light paper. The id changes if the cells in the image are the
// code of another marker of the dictionary, and that marker fits clearly better. `sides_mm` and
// `camera` as in RefineMarkers().
ReadMarker RefineAndReadAgain(const cv::Mat& gray, const MarkerQuad& quad,
                              const Dictionary& dictionary, int border_bits,
                              const ImageFormation& formation,
                              const std::vector<double>& sides_mm = {},
                              const Camera* camera = nullptr);

}  // namespace velamap
