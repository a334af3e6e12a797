// The scene for AliceVision and its program Meshroom: images, cameras, poses and the corners as
// landmarks, in AliceVision's JSON format SfMData (.sfm).

#pragma once

#include <iosfwd>

#include "reconstruct/model/model.h"

namespace velamap {

// Writes SfMData 1.2.6 with the keys and conventions of AliceVision's src/aliceVision/sfmDataIO/
// jsonIO.cpp and of its sample compatibilityData/scene_v1.2.6.json, which AliceVision's tests still
// read with 1.2.14. Coordinates are those of the model, m for a metric one; the id of a landmark is
// 10 * marker id + corner. The path of an image is its name in the model. Pixels are AliceVision's,
// which have (0,0) at the centre of the first pixel as OpenCV's: camera/cameraUndistortImage.hpp
// takes pixels as they are at whole numbers. The rolling shutter that the adjustment estimated is
// removed from them.
//
// Throws InputError for a camera with a rational distortion, which AliceVision does not have.
void WriteAliceVisionScene(const Model& model, std::ostream& out);

}  // namespace velamap
