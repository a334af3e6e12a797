// The marker shape as PLY, for MeshLab, CloudCompare and Blender. Positions in m.
//
// `frame` describes the frame of the shape in a comment of the header; empty for none. If every
// written point has a sigma, the vertices have the float property sigma too: the root of the mean
// variance along x, y and z, m.

#pragma once

#include <array>
#include <iosfwd>
#include <string>

#include "exporters/formats/ply_writer.h"
#include "exporters/shape/marker_shape.h"
#include "reconstruct/model/model.h"

namespace velamap {

// The vertices of the face of a whole marker whose corners 1..4 are the vertices from `first` on.
// Corners run clockwise seen from the front; a face runs the other way, so that its normal is the
// outward one.
constexpr std::array<int, 4> MarkerFace(int first) {
  return {first, first + 3, first + 2, first + 1};
}

// Writes every corner and centre as a vertex: double x y z, float nx ny nz (the normal of the
// marker, zero if it is not whole), uchar red green blue (of the model's points; a centre gets the
// mean of its corners), int marker_id, int corner.
void WritePointsPly(const MarkerShape& shape, const Model& metric_model, PlyFormat format,
                    std::ostream& out, const std::string& frame = "");

// Writes every whole marker as a quadrilateral (MarkerFace()): four vertices with double x y z,
// float nx ny nz, uchar red green blue (one colour per part), int marker_id, int corner, and faces
// with vertex_indices and int marker_id.
void WriteMarkersPly(const MarkerShape& shape, PlyFormat format, std::ostream& out,
                     const std::string& frame = "");

}  // namespace velamap
