#include "importer/database/correspondence.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/importer/marker_builders.h"

namespace velamap {
namespace {

// Positions of the four symbols that are set.
std::array<int, 4> Symbols(const Descriptor& descriptor) {
  std::array<int, 4> symbols{};
  int num_set = 0;
  for (int i = 0; i < 128; ++i) {
    if (descriptor[static_cast<std::size_t>(i)] == 0) continue;
    EXPECT_EQ(descriptor[static_cast<std::size_t>(i)], 255);
    EXPECT_EQ(i / 32, num_set) << "one symbol a block";
    if (num_set < 4) symbols[static_cast<std::size_t>(num_set)] = i;
    ++num_set;
  }
  EXPECT_EQ(num_set, 4);
  return symbols;
}

TEST(EncodeDescriptor, DifferentCornersShareAtMostTwoSymbols) {
  std::vector<std::array<int, 4>> codes;
  for (int id = 0; id < 1000; ++id) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      codes.push_back(Symbols(EncodeDescriptor({id, corner})));
    }
  }
  int max_shared = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      int shared = 0;
      for (std::size_t k = 0; k < 4; ++k) shared += codes[i][k] == codes[j][k];
      max_shared = std::max(max_shared, shared);
    }
  }
  EXPECT_EQ(max_shared, 2);
  // In COLMAP's metric: equal ones below its limit of 0.7 rad and the ratio of 0.8, others beyond.
  const auto angle = [](int shared) { return std::acos(shared * 255.0 * 255.0 / (512 * 512)); };
  EXPECT_NEAR(angle(4), 0.12, 0.01);
  EXPECT_GT(angle(max_shared), 1.05);
}

TEST(EncodeDescriptor, StaysDistinctUpToTheLargestId) {
  std::set<Descriptor> descriptors;
  for (int id = kMaxMarkerId - 500; id <= kMaxMarkerId; ++id) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      descriptors.insert(EncodeDescriptor({id, corner}));
      descriptors.insert(EncodeDescriptor({id - 7000, corner}));
    }
  }
  EXPECT_EQ(descriptors.size(), 2u * 501 * kNumCorners);
  EXPECT_THROW(EncodeDescriptor({kMaxMarkerId + 1, 1}), std::logic_error);
  EXPECT_THROW(EncodeDescriptor({1, 0}), std::logic_error);
}

TEST(MatchByMarkerId, PairsTheFourCornersOfSharedMarkers) {
  FrameDetections a, b;
  a.markers = {SquareMarker(2, 0, 0), SquareMarker(5, 0, 0), SquareMarker(9, 0, 0)};
  b.markers = {SquareMarker(1, 0, 0), SquareMarker(5, 0, 0), SquareMarker(7, 0, 0),
               SquareMarker(9, 0, 0)};
  EXPECT_EQ(MatchByMarkerId(a, b),
            (FeatureMatches{{4, 4}, {5, 5}, {6, 6}, {7, 7}, {8, 12}, {9, 13}, {10, 14}, {11, 15}}));
  EXPECT_TRUE(MatchByMarkerId(a, FrameDetections{}).empty());
}

using Pairs = std::vector<std::pair<int, int>>;

// Images that show the given markers.
std::vector<FrameDetections> ImagesOf(const std::vector<std::vector<int>>& marker_ids) {
  std::vector<FrameDetections> images;
  for (const std::vector<int>& ids : marker_ids) {
    FrameDetections& image = images.emplace_back();
    for (const int id : ids) image.markers.push_back(SquareMarker(id, 0, 0));
  }
  return images;
}

TEST(PairsToMatch, AllPairsOfFewImagesThatShareAMarker) {
  EXPECT_TRUE(PairsToMatch({}).empty());
  EXPECT_TRUE(PairsToMatch(ImagesOf({{1}})).empty());
  EXPECT_EQ(PairsToMatch(ImagesOf({{1, 2}, {2, 3}, {}, {1, 3}})), (Pairs{{0, 1}, {0, 3}, {1, 3}}));
  const std::vector<FrameDetections> images(kMaxNumExhaustive, ImagesOf({{1}})[0]);
  EXPECT_EQ(PairsToMatch(images).size(), kMaxNumExhaustive * (kMaxNumExhaustive - 1u) / 2);
}

TEST(PairsToMatch, NeighborsAndPowersOfTwoOfMany) {
  const int num_images = 1500;
  std::set<int> distances;
  std::set<std::pair<int, int>> pairs;
  for (const auto& [first, second] :
       PairsToMatch(std::vector<FrameDetections>(num_images, ImagesOf({{1}})[0]))) {
    EXPECT_LT(first, second);
    EXPECT_LT(second, num_images);
    EXPECT_TRUE(pairs.insert({first, second}).second);
    distances.insert(second - first);
  }
  EXPECT_EQ(distances, (std::set<int>{1, 2, 3, 4, 8, 16, 32, 64, 128, 256, 512}));
  for (const int distance : distances) EXPECT_EQ(pairs.count({0, distance}), 1u);
}

// The images that show a marker form one group under the pairs, however rarely they show it.
TEST(PairsToMatch, TracksOfAllMarkersAreConnected) {
  constexpr int kNumImages = 300, kNumMarkers = 60;
  std::mt19937 random(1);
  std::vector<std::vector<int>> marker_ids(kNumImages);
  std::vector<std::vector<int>> images_of(kNumMarkers);
  for (int idx = 0; idx < kNumImages; ++idx) {
    for (int id = 0; id < kNumMarkers; ++id) {
      if (static_cast<int>(random() % 100) > id) continue;  // from one image in 100 to half of them
      marker_ids[static_cast<std::size_t>(idx)].push_back(id);
      images_of[static_cast<std::size_t>(id)].push_back(idx);
    }
  }
  const Pairs pairs = PairsToMatch(ImagesOf(marker_ids));
  EXPECT_LT(pairs.size(), kNumImages * (kNumImages - 1u) / 4);
  for (const std::vector<int>& images : images_of) {
    std::set<int> reached(images.begin(), images.empty() ? images.end() : images.begin() + 1);
    for (bool has_grown = true; has_grown;) {
      has_grown = false;
      for (const auto& [first, second] : pairs) {
        if (std::count(images.begin(), images.end(), first) == 0 ||
            std::count(images.begin(), images.end(), second) == 0 ||
            reached.count(first) == reached.count(second)) {
          continue;
        }
        has_grown = true;
        reached.insert(first);
        reached.insert(second);
      }
    }
    EXPECT_EQ(reached.size(), images.size());
  }
}

}  // namespace
}  // namespace velamap
