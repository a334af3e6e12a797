#include "importer/rotation/rotation_evidence.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importer/marker_builders.h"

namespace velamap {
namespace {

using ::testing::IsEmpty;

const CodeSymmetries kHalf = {{5, {2}}, {6, {2}}};

// The surface seen turned and foreshortened, another way in each frame.
FrameDetections Frame(int idx, std::vector<MarkerDetection> markers) {
  const double a = 0.7 * idx;
  Eigen::Matrix2d image_from_surface;
  image_from_surface << std::cos(a), -std::sin(a), std::sin(a), std::cos(a);
  image_from_surface.col(0) *= 0.6 + 0.1 * (idx % 4);
  for (MarkerDetection& marker : markers) {
    for (Eigen::Vector2d& x : marker.corners_in_image_px) x = image_from_surface * x;
  }
  FrameDetections frame;
  frame.image_name = std::to_string(idx);
  frame.markers = std::move(markers);
  return frame;
}

// Marker 1 stands as marker 5 does and tells how it stands; marker 2 stands across and does not.
FrameDetections Clear(int idx, int first = 0) {
  return Frame(idx, {TurnedMarker(1, 100, 100, 0), TurnedMarker(2, 160, 100, 88),
                     TurnedMarker(5, 130, 100, 0, first)});
}

FrameDetections Doubtful(int idx, int first) {
  return Frame(idx, {TurnedMarker(2, 160, 100, 88), TurnedMarker(5, 130, 100, 0, first)});
}

bool IsRight(const FrameDetections& frame, int id) {
  const auto found = std::find_if(frame.markers.begin(), frame.markers.end(),
                                  [&](const auto& marker) { return marker.marker_id == id; });
  return found != frame.markers.end() && found->corner_sigma_px[0] == 0.01 &&
         found->corner_sigma_px[3] == 0.04;
}

TEST(ResolveRotationsAcrossFrames, OtherFramesDecideWhereNeighboursLeaveADoubt) {
  for (const int first : {0, 2}) {
    std::vector<FrameDetections> frames = {Doubtful(0, first), Clear(1), Clear(2, 2), Clear(3)};
    const auto changed = ResolveRotationsAcrossFrames(kHalf, {}, &frames);
    for (const FrameDetections& frame : frames) {
      EXPECT_TRUE(IsRight(frame, 5)) << frame.image_name;
      EXPECT_THAT(frame.rejected, IsEmpty());
    }
    EXPECT_EQ(changed.front(), first == 2 ? 0u : 2u);
  }
}

TEST(ResolveRotationsAcrossFrames, ResolvedSymmetricMarkersAreEvidence) {
  // Marker 6 is seen with a telling neighbour and, elsewhere, only with 5 and a marker across.
  std::vector<FrameDetections> frames;
  for (int i = 0; i < 4; ++i) {
    frames.push_back(Frame(i, {TurnedMarker(1, 100, 100, 0), TurnedMarker(2, 160, 100, 88),
                               TurnedMarker(5, 130, 100, 0), TurnedMarker(6, 130, 140, 0, 2)}));
  }
  frames.push_back(Frame(7, {TurnedMarker(2, 160, 100, 88), TurnedMarker(5, 130, 100, 0, 2),
                             TurnedMarker(6, 130, 140, 0)}));
  // Neither 1 nor 2 here, but 3, of which nobody knows anything.
  frames.push_back(Frame(8, {TurnedMarker(3, 400, 100, 90), TurnedMarker(5, 130, 100, 0)}));
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(IsRight(frames[i], 5)) << i;
    EXPECT_TRUE(IsRight(frames[i], 6)) << i;
  }
  ASSERT_EQ(frames[5].rejected.size(), 1u);
  EXPECT_EQ(frames[5].rejected[0].reason, kDoubtfulRotation);
}

TEST(ResolveRotationsAcrossFrames, TwoFramesAreNotEnough) {
  std::vector<FrameDetections> frames = {Doubtful(0, 2), Clear(1), Clear(2)};
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  EXPECT_EQ(frames[0].rejected.size(), 1u);
}

TEST(ResolveRotationsAcrossFrames, FramesThatContradictEachOtherSayNothing) {
  // In every other frame marker 1 hangs upside down, and marker 5 follows it.
  std::vector<FrameDetections> frames = {Doubtful(0, 2)};
  for (int i = 1; i <= 8; ++i) {
    frames.push_back(Frame(i, {TurnedMarker(1, 100, 100, i % 2 == 0 ? 0 : 180),
                               TurnedMarker(2, 160, 100, 88), TurnedMarker(5, 130, 100, 0)}));
  }
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  EXPECT_EQ(frames[0].rejected.size(), 1u);
}

TEST(ResolveRotationsAcrossFrames, OneWrongFrameAmongManyIsOutvoted) {
  std::vector<FrameDetections> frames = {Doubtful(0, 2)};
  for (int i = 1; i <= 12; ++i) {
    frames.push_back(Frame(i, {TurnedMarker(1, 100, 100, i == 5 ? 180 : 0),
                               TurnedMarker(2, 160, 100, 88), TurnedMarker(5, 130, 100, 0)}));
  }
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  EXPECT_TRUE(IsRight(frames[0], 5));
}

TEST(ResolveRotationsAcrossFrames, FalseIdsElsewhereSayNothing) {
  // What passes for marker 2 stands upside down at another place.
  std::vector<FrameDetections> frames = {
      Frame(0, {TurnedMarker(2, 330, 250, -88), TurnedMarker(5, 130, 100, 0)}), Clear(1), Clear(2),
      Clear(3)};
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  EXPECT_EQ(frames[0].rejected.size(), 1u);
}

TEST(ResolveRotationsAcrossFrames, MarkersThatHaveBeenTurnedSinceSayNothing) {
  std::vector<FrameDetections> frames;
  for (int i = 0; i < 4; ++i) {
    frames.push_back(Frame(i, {TurnedMarker(1, 100, 100, 0), TurnedMarker(2, 160, 100, 88),
                               TurnedMarker(3, 130, 140, 92), TurnedMarker(5, 130, 100, 0)}));
  }
  frames.push_back(Frame(4, {TurnedMarker(2, 160, 100, 88), TurnedMarker(3, 130, 140, -88),
                             TurnedMarker(5, 130, 100, 0, 2)}));
  frames.push_back(Frame(5, {TurnedMarker(3, 130, 140, -88), TurnedMarker(5, 130, 100, 0)}));
  ResolveRotationsAcrossFrames(kHalf, {}, &frames);
  EXPECT_TRUE(IsRight(frames[4], 5));
  EXPECT_EQ(frames[5].rejected.size(), 1u);
}

TEST(ResolveRotationsAcrossFrames, MarkerThatStandsAcrossWhatIsKnownStaysInDoubt) {
  std::vector<FrameDetections> frames = {Clear(1), Clear(2), Clear(3), Clear(4)};
  frames.push_back(Frame(4, {TurnedMarker(1, 100, 100, 0), TurnedMarker(2, 160, 100, 88),
                             TurnedMarker(5, 130, 100, 85)}));
  ResolveRotationsAcrossFrames({{5, {2}}}, {{5, {1}}, {1, {5}}}, &frames);
  EXPECT_EQ(frames[4].rejected.size(), 1u);
}

TEST(ResolveRotationsAcrossFrames, QuarterTurnsNeedACloserFit) {
  const CodeSymmetries quarter = {{5, {1, 2, 3}}};
  const auto doubtful = [](double angle_deg) {
    return Frame(0, {TurnedMarker(2, 160, 100, 45), TurnedMarker(5, 130, 100, angle_deg, 3)});
  };
  for (const double angle_deg : {10.0, 30.0}) {
    std::vector<FrameDetections> frames = {doubtful(angle_deg)};
    for (int i = 1; i < 4; ++i) {
      frames.push_back(Frame(4 * i, {TurnedMarker(1, 100, 100, 0), TurnedMarker(2, 160, 100, 45),
                                     TurnedMarker(4, 100, 130, 0), TurnedMarker(7, 130, 130, 0),
                                     TurnedMarker(5, 130, 100, 0)}));
    }
    const AdjacencyGraph graph = {{5, {1, 4, 7}}, {1, {5}}, {4, {5}}, {7, {5}}, {2, {}}};
    ResolveRotationsAcrossFrames(quarter, graph, &frames);
    EXPECT_EQ(frames[0].rejected.size(), angle_deg > 22.5 ? 1u : 0u) << angle_deg;
  }
}

TEST(ResolveRotationsAcrossFrames, OrderAndEarlierCallsChangeNothing) {
  std::vector<FrameDetections> frames;
  for (int i = 0; i < 12; ++i) frames.push_back(i % 3 == 0 ? Doubtful(i, 2) : Clear(i, 2));
  std::vector<FrameDetections> at_once = frames;
  ResolveRotationsAcrossFrames(kHalf, {}, &at_once);

  std::vector<FrameDetections> first(frames.begin(), frames.begin() + 7);
  ResolveRotationsAcrossFrames(kHalf, {}, &first);
  first.insert(first.end(), frames.begin() + 7, frames.end());
  std::mt19937 random(3);
  std::shuffle(first.begin(), first.end(), random);
  ResolveRotationsAcrossFrames(kHalf, {}, &first);
  for (const FrameDetections& frame : first) {
    const FrameDetections& same = at_once[static_cast<std::size_t>(std::stoi(frame.image_name))];
    ASSERT_EQ(frame.markers.size(), same.markers.size());
    for (std::size_t i = 0; i < frame.markers.size(); ++i) {
      EXPECT_EQ(frame.markers[i].corners_in_image_px, same.markers[i].corners_in_image_px);
    }
  }
  EXPECT_THAT(ResolveRotationsAcrossFrames(kHalf, {}, &at_once), IsEmpty());
}

}  // namespace
}  // namespace velamap
