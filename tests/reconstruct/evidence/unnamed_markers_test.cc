#include "reconstruct/evidence/unnamed_markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reconstruct/registration_fixture.h"
#include "tests/support/true_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kForgotten = 900, kMisread = 901, kFalse = 902;

class UnnamedMarkers : public testing::Test {
 protected:
  // Adds a detection beside the first marker of the image, or in its place.
  void Reject(int marker_id, const char* reason, double sides_away, DatabaseImage* image) const {
    RejectedDetection rejected{image->detections.markers.at(0), reason};
    auto& corners = rejected.detection.corners_in_image_px;
    const double away_px = sides_away * (corners[1] - corners[0]).norm();
    rejected.detection.marker_id = marker_id;
    for (Eigen::Vector2d& corner : corners) corner.y() -= away_px;
    image->detections.rejected.push_back(rejected);
  }

  const SyntheticScene scene_ = MakeSyntheticScene({});
  const Model model_ = TrueModel(scene_);
  std::vector<DatabaseImage> images_ = DatabaseImages(scene_);
};

TEST_F(UnnamedMarkers, OnlyThoseThatStandOnTheirOwnAndAreSeenAsOftenAsOthers) {
  EXPECT_THAT(FindUnnamedMarkers(images_, model_), IsEmpty());
  for (std::size_t i = 0; i < images_.size(); ++i) {
    if (i % 2 == 0) Reject(kForgotten, kNotInLayout, 1.2, &images_[i]);
    Reject(kMisread, kNotInLayout, 0.1, &images_[i]);
    if (i < 2) Reject(kFalse, kNotInLayout, 1.2, &images_[i]);
    Reject(7, "duplicated id", 1.2, &images_[i]);
  }
  EXPECT_THAT(FindUnnamedMarkers(images_, model_), ElementsAre(kForgotten));
}

}  // namespace
}  // namespace velamap
