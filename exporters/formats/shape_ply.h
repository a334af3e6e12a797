// PLY files that MeshLab, CloudCompare and Blender open. Positions in m.

#pragma once

#include <iosfwd>
#include <string>

#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/model.h"

namespace velamap {

enum class PlyFormat { kBinaryLittleEndian, kAscii };

// `frame` says in words what frame the shape is in, for a comment in the header; empty: none.
//
// Where every point written has a sigma, vertices have the float property sigma too: the root of
// the mean variance along x, y and z, m.

// Vertices: every corner and centre with double x y z, float nx ny nz (the marker's normal; zero
// where the marker is not whole), uchar red green blue (of the model's points; the centre gets the
// mean of its corners), int marker_id, int corner.
void WritePointsPly(const MarkerShape& shape, const Model& metric_model, PlyFormat format,
                    std::ostream& out, const std::string& frame = "");

// One quadrilateral a whole marker, seen from the front counter-clockwise, so that its normal is
// the marker's outward one: four vertices with double x y z, float nx ny nz, uchar red green blue
// (one colour a part), int marker_id, int corner, and faces with vertex_indices and int marker_id.
void WriteMarkersPly(const MarkerShape& shape, PlyFormat format, std::ostream& out,
                     const std::string& frame = "");

}  // namespace velamap
