// A small exact model to export: square markers of two sizes on a cylinder and on a flat hull, all
// seen by three cameras. Unit m, so that its true scale is 1.

#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"

namespace velamap {

// Sail with markers 1..6 of 100 mm in two lines, hull with 120 and 121, 121 of 50 mm.
Layout ExampleLayout();

Model ExampleModel();

// Adds uniform noise of up to `max_px` to every image point; the same seed gives the same noise.
void AddImageNoise(double max_px, std::uint32_t seed, Model* model);

// A marker in the marker frame moved by `shape_from_marker`: whole, with a centre.
ShapeMarker SquareMarker(int marker_id, double length_m, const Rigid3& shape_from_marker = {});

// A similarity with this scale, a rotation about an arbitrary axis, and a translation.
Sim3 ExampleSim3(double scale);

// The text that a writer writes.
std::string Written(const std::function<void(std::ostream&)>& write);

}  // namespace velamap
