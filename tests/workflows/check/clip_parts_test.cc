#include "workflows/check/clip_parts.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "importer/geometry/units.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kNumLookedAt = 40;

// 40 frames, every third of a video, of eight markers on a sail and four on a hull. The camera goes
// around them by 2 degrees a frame.
struct FilmedClip {
  std::vector<DatabaseImage> images;
  ClipPrecision precision;
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  FrameTimes times{0, 3, kNumLookedAt, 0.0, 1.0 / 30};

  FilmedClip() {
    layout.parts.resize(2);
    layout.parts[0].name = "sail";
    layout.parts[0].marker_ids = {0, 1, 2, 3, 4, 5, 6, 7};
    layout.parts[1].name = "hull";
    layout.parts[1].marker_ids = {8, 9, 10, 11};
    images.resize(kNumLookedAt);
    for (int i = 0; i < kNumLookedAt; ++i) {
      FrameDetections& frame = images[static_cast<std::size_t>(i)].detections;
      frame.frame_number = 3 * i;
      frame.time_s = 0.1 * i;
      frame.image_name = NameOfVideoFrame(3 * i);
      for (int marker_id = 0; marker_id < 12; ++marker_id) {
        MarkerDetection marker;
        marker.marker_id = marker_id;
        marker.corner_sigma_px.fill(0.05);
        frame.markers.push_back(marker);
      }
      const double angle = kRadPerDeg * 2 * i;
      precision.directions[frame.image_name] = {std::cos(angle), std::sin(angle), 0};
    }
  }

  void Change(int begin, int end, const std::function<void(FrameDetections* frame)>& change) {
    for (int i = begin; i < end; ++i) change(&images[static_cast<std::size_t>(i)].detections);
  }
  std::vector<ClipPart> Parts() const { return FindClipParts(images, times, layout, &precision); }
};

void Keep(int begin_id, int end_id, FrameDetections* frame) {
  std::vector<MarkerDetection> kept;
  for (const MarkerDetection& marker : frame->markers) {
    if (marker.marker_id >= begin_id && marker.marker_id < end_id) kept.push_back(marker);
  }
  frame->markers = kept;
}

void Blur(FrameDetections* frame) {
  for (MarkerDetection& marker : frame->markers) marker.corner_sigma_px.fill(0.12);
}

testing::Matcher<ClipPart> Good(int first_frame, int last_frame) {
  return AllOf(Field(&ClipPart::first_frame, first_frame), Field(&ClipPart::last_frame, last_frame),
               Field(&ClipPart::lacks, IsEmpty()));
}

testing::Matcher<ClipPart> Poor(int first_frame, int last_frame, const char* lacks) {
  return AllOf(Field(&ClipPart::first_frame, first_frame), Field(&ClipPart::last_frame, last_frame),
               Field(&ClipPart::lacks, HasSubstr(lacks)));
}

TEST(ClipParts, AGoodClipIsOnePart) {
  const std::vector<ClipPart> parts = FilmedClip().Parts();
  ASSERT_THAT(parts, ElementsAre(Good(0, 117)));
  EXPECT_EQ(parts[0].num_markers, 12);
  EXPECT_NEAR(*parts[0].parallax_deg, 78, 1e-6);
  EXPECT_NEAR(parts[0].end_s, 3.9, 1e-9);
}

TEST(ClipParts, BlurredFramesEndAPart) {
  FilmedClip clip;
  clip.Change(15, 20, Blur);
  EXPECT_THAT(clip.Parts(), ElementsAre(Good(0, 42), Poor(45, 57, "blurred"), Good(60, 117)));
}

TEST(ClipParts, AFewPoorFramesDoNotEndAPart) {
  FilmedClip clip;
  clip.Change(15, 17, Blur);
  clip.Change(30, 31, [](FrameDetections* frame) { Keep(0, 3, frame); });
  EXPECT_THAT(clip.Parts(), ElementsAre(Good(0, 117)));
}

TEST(ClipParts, ManyMarkersFromOnePlaceAreNoGoodPart) {
  FilmedClip clip;
  const Eigen::Vector3d last = clip.precision.directions.at(NameOfVideoFrame(3 * 19));
  clip.Change(15, 20, [](FrameDetections* frame) { frame->markers.clear(); });
  for (int i = 20; i < kNumLookedAt; ++i) {
    clip.precision.directions[NameOfVideoFrame(3 * i)] = last;
  }
  EXPECT_THAT(clip.Parts(), ElementsAre(Good(0, 42), Poor(45, 57, "fewer than four markers"),
                                        Poor(60, 117, "only 0 degrees around the object")));
}

TEST(ClipParts, EveryPartOfTheLayoutHasToBeSeen) {
  FilmedClip clip;
  clip.Change(15, 20, Blur);
  clip.Change(20, 40, [](FrameDetections* frame) { Keep(0, 8, frame); });
  EXPECT_THAT(clip.Parts(), ElementsAre(Good(0, 42), Poor(45, 57, "blurred"),
                                        Poor(60, 117, "lacks 4 of 4 markers of hull")));
}

TEST(ClipParts, FramesThatShareNoMarkersAreTwoParts) {
  FilmedClip clip;
  clip.layout.parts.clear();
  clip.Change(0, 20, [](FrameDetections* frame) { Keep(0, 6, frame); });
  clip.Change(20, 40, [](FrameDetections* frame) { Keep(6, 12, frame); });
  EXPECT_THAT(clip.Parts(), ElementsAre(Poor(0, 57, "lacks 6 of 12 markers"),
                                        Poor(60, 117, "lacks 6 of 12 markers")));
}

TEST(ClipParts, FramesThatContradictTheOthersAndThoseWithoutMarkersAreNamed) {
  FilmedClip clip;
  for (int i = 30; i < 40; ++i) {
    clip.precision.contradicting_images.insert(NameOfVideoFrame(3 * i));
  }
  clip.images.erase(clip.images.begin(), clip.images.begin() + 5);  // as the importer leaves them
  const std::vector<ClipPart> parts = clip.Parts();
  EXPECT_THAT(parts, ElementsAre(Poor(0, 12, "fewer than four markers"), Good(15, 87),
                                 Poor(90, 117, "contradicts the other frames")));
  EXPECT_NEAR(parts[0].end_s, 0.4, 1e-9);
}

TEST(ClipParts, WithoutSizesNothingIsKnownOfTheAngle) {
  const FilmedClip clip;
  const auto parts = FindClipParts(clip.images, clip.times, clip.layout, nullptr);
  ASSERT_THAT(parts, ElementsAre(Good(0, 117)));
  EXPECT_FALSE(parts[0].parallax_deg);
}

}  // namespace
}  // namespace velamap
