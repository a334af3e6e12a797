// From detections to what COLMAP matches: keypoints, descriptors, image pairs and matches.

#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/detect/detection.h"

namespace velamap {

// 128 bytes of a SIFT descriptor that encode one corner's identity.
using Descriptor = std::array<std::uint8_t, 128>;

// A code of four symbols out of 32, the fourth a checksum of the others, each a single 255 in its
// block of 32 bytes: two corners share at most two symbols. COLMAP (feature/sift.cc) compares
// descriptors by the angle acos(a.b / 512^2); equal ones are 0.12 rad apart and others at least
// 1.05, which its limits (0.7 rad, ratio 0.8) tell apart with ease.
Descriptor EncodeDescriptor(const CornerId& id);

// The corners that two images share, by marker id, as keypoint indices.
FeatureMatches MatchByMarkerId(const FrameDetections& image1, const FrameDetections& image2);

// Pairs (first < second, positions in a list of images ordered by name) that are worth matching:
// all of them up to `max_exhaustive` images, beyond it those of COLMAP's sequential_matcher with
// overlap 10 and quadratic overlap (distances 1..10 and powers of two up to 2^9).
std::vector<std::pair<int, int>> PairsToMatch(int num_images, int max_exhaustive = 200);

}  // namespace velamap
