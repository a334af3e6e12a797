#include "workflows/proposal/print_faults.h"

#include <gmock/gmock.h>

#include "importer/layout/dictionary.h"
#include "tests/support/render/marker_renderer.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

const Camera kCamera{CameraModel::kPinhole, 480, 160, {400, 400, 240, 80}};

// Markers 1, 2 and 3 beside each other; the pictures of the last two may be changed.
std::vector<Frame> Pictures(bool mirrors_second, bool inverts_third) {
  const Dictionary dictionary = LoadDictionary("DICT_4X4_50");
  std::vector<Frame> frames;
  for (int i = 0; i < 3; ++i) {
    std::vector<PlacedMarkerInCam> markers;
    for (int id = 1; id <= 3; ++id) {
      const double x_m = 0.3 * (id - 2) + 0.01 * i;
      markers.push_back({id,
                         {Eigen::Vector3d(x_m - 0.07, -0.07, 1),
                          {x_m + 0.07, -0.07, 1},
                          {x_m + 0.07, 0.07, 1},
                          {x_m - 0.07, 0.07, 1}}});
    }
    Frame frame;
    frame.image_name = std::to_string(i);
    frame.gray = RenderMarkers(kCamera, markers, dictionary, 1, {});
    cv::Mat second = frame.gray(cv::Rect(180 + 4 * i, 0, 120, 160));
    cv::Mat third = frame.gray(cv::Rect(320, 0, 160, 160));
    if (mirrors_second) cv::flip(second.clone(), second, 1);
    if (inverts_third) cv::bitwise_not(third, third);
    frames.push_back(frame);
  }
  return frames;
}

PrintFaults Find(const std::vector<Frame>& frames) {
  return FindPrintFaults(frames, {}, MakeLayout("DICT_4X4_50", 0.1), {});
}

TEST(PrintFaults, MirroredAndInvertedMarkersAreNamed) {
  const PrintFaults faults = Find(Pictures(true, true));
  EXPECT_THAT(faults.mirrored, ElementsAre(Pair(2, 3)));
  EXPECT_THAT(faults.inverted, ElementsAre(Pair(3, 3)));
  EXPECT_THAT(DescribeFaults(faults, 10, 3),
              ElementsAre(HasSubstr("marker 2 is mirrored, as 3 of 3 frames show"),
                          HasSubstr("marker 3 is printed with black and white exchanged")));
}

TEST(PrintFaults, GoodPrintsHaveNone) {
  const PrintFaults faults = Find(Pictures(false, false));
  EXPECT_THAT(faults.mirrored, IsEmpty());
  EXPECT_THAT(faults.inverted, IsEmpty());
}

TEST(PrintFaults, AMirroredClipIsOneLine) {
  PrintFaults faults;
  for (int id = 0; id < 8; ++id) faults.mirrored[id] = 3;
  EXPECT_THAT(DescribeFaults(faults, 0, 3), ElementsAre(HasSubstr("markers 0-7 are mirrored")));
}

}  // namespace
}  // namespace velamap
