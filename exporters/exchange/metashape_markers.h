// Corners of markers for Agisoft Metashape, whose own markers are points: "17_1" is corner 1 of
// marker 17. Metashape knows pictures by their file names without the extension.

#pragma once

#include <iosfwd>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Writes where each picture shows which corner, as File > Import > Import Markers reads it. Pixels
// are COLMAP's and Metashape's alike: the centre of the first one is at (0.5, 0.5), see "Camera
// models" in Metashape's manual. The rolling shutter that the adjustment estimated is removed from
// them. Throws InputError if two pictures have one name in Metashape.
void WriteMetashapeMarkers(const Model& model, std::ostream& out);

// Writes the coordinates of the corners as CSV for File > Import > Import Reference, with
// the columns label, x, y, z and accuracy, m. The accuracy is the RMS of the sigmas along x, y and
// z; empty if unknown.
void WriteMetashapeReference(const MarkerShape& shape, std::ostream& out);

}  // namespace velamap
