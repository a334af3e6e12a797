// Descriptors, image pairs and matches, by marker id.

#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/detect/detection.h"

namespace velamap {

// As long as a SIFT descriptor, so that COLMAP's matchers take it for one.
using Descriptor = std::array<std::uint8_t, 128>;

// Encodes the corner as four symbols out of 32, the fourth being a checksum of the others. A symbol
// is a single 255 in its block of 32 bytes, and two corners share at most two symbols. COLMAP
// (feature/sift.cc) compares descriptors by the angle acos(a.b / 512^2): descriptors of one corner
// are 0.12 rad apart and those of two corners at least 1.05 rad, so COLMAP's limits (0.7 rad, ratio
// 0.8) separate them.
Descriptor EncodeDescriptor(const CornerId& id);

// Returns the corners of the markers that both images show, as keypoint indices.
FeatureMatches MatchByMarkerId(const FrameDetections& image1, const FrameDetections& image2);

// Up to this number of images, all pairs are matched.
constexpr int kMaxNumExhaustive = 200;

// Returns the pairs of images whose matches are written (first < second, indices into `images`,
// which are ordered by name). Up to kMaxNumExhaustive images these are all pairs that share a
// marker. Matches of all pairs would take most of the space of a larger database, so there each
// image is paired with its neighbours, as COLMAP's sequential_matcher does with quadratic overlap
// (1 to 4 and powers of two up to 512 apart), and, for each of its markers, with the next image
// that shows the marker: the track of every corner is connected.
std::vector<std::pair<int, int>> PairsToMatch(const std::vector<FrameDetections>& images);

}  // namespace velamap
