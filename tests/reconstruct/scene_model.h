// The model of a synthetic scene: true poses and points, the detections of its frames as tracks.

#pragma once

#include <cstdint>
#include <functional>

#include "reconstruct/model/model.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

// Image i + 1 is frame i; keypoints in order of the detections. Corners seen by fewer than two
// frames are left out.
Model MakeSceneModel(const SyntheticScene& scene);

// The scene with every marker's corners displaced, so that its sides are wrong by independent
// normal errors of `tolerance` (a fraction), the difference of its diagonals by root two times
// that, and its corners leave its plane by `flatness` sides; detections are projected anew, without
// noise.
SyntheticScene WithPrintErrors(const SyntheticScene& scene, double tolerance, double flatness,
                               std::uint32_t seed);

// Scales the world of one marker about its centre; detections are projected anew.
void ResizeMarker(int marker_id, double factor, SyntheticScene* scene);

// Moves one corner of a marker towards its centre, by this share of the distance.
void PullCorner(int marker_id, int corner, double share, SyntheticScene* scene);

// Moves the corners of each detection inwards, by `inset_px` of it from both sides.
void AddInset(const std::function<double(const MarkerDetection&)>& inset_px, SyntheticScene* scene);

// Projects all markers of all detections anew.
void ProjectAnew(SyntheticScene* scene);

}  // namespace velamap
