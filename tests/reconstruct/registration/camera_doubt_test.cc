#include "reconstruct/registration/registration.h"

#include <cstddef>
#include <string>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// `num_left_out` of 100 frames show `num_shared` markers of the shape and are not registered.
Registration RegistrationOf(int num_left_out, int num_shared) {
  Registration registration;
  for (int i = 0; i < 100; ++i) {
    RegisteredFrame frame;
    if (i < num_left_out) {
      ExplainWhyNotRegistered(num_shared, 12, 4, &frame);
    } else {
      frame.cam_from_shape = Rigid3();
    }
    registration.frames.push_back(frame);
  }
  return registration;
}

TEST(CameraDoubt, ManyFramesOfManyMarkersAreOfAnotherCamera) {
  EXPECT_THAT(CameraDoubt(RegistrationOf(50, 12)), HasSubstr("50 of 100 images show 8 or more"));
  EXPECT_THAT(CameraDoubt(RegistrationOf(20, 8)), HasSubstr("of another camera"));
}

TEST(CameraDoubt, FewFramesAreNoReason) {
  EXPECT_THAT(CameraDoubt(RegistrationOf(0, 12)), IsEmpty());
  EXPECT_THAT(CameraDoubt(RegistrationOf(19, 12)), IsEmpty());
}

TEST(CameraDoubt, FewMarkersCanBeFalseOnes) {
  EXPECT_THAT(CameraDoubt(RegistrationOf(50, 7)), IsEmpty());
}

TEST(CameraDoubt, FramesThatShareTooFewMarkersContradictNothing) {
  EXPECT_THAT(CameraDoubt(RegistrationOf(50, 3)), IsEmpty());
  EXPECT_THAT(RegistrationOf(1, 3).frames.front().left_out.reason,
              HasSubstr("shares 3 of its 12 markers with the registered images; 4 are needed"));
}

RegisteredFrame FrameWithOutliers(int num_inliers, int num_own, int num_dropped) {
  RegisteredFrame frame;
  frame.cam_from_shape = Rigid3();
  for (int i = 0; i < num_inliers; ++i) frame.marker_ids.push_back(i);
  for (int i = 0; i < num_own + num_dropped; ++i) {
    const bool is_dropped = i >= num_own;
    frame.outliers.push_back(
        {100 + i, is_dropped ? "a false square" : "3.1 px from its place", is_dropped});
  }
  CountContradictions(&frame);
  return frame;
}

TEST(CountContradictions, ManyOutliersOfAFrameAreContradictions) {
  EXPECT_EQ(FrameWithOutliers(24, 8, 0).num_contradicting, 8);
  EXPECT_EQ(FrameWithOutliers(42, 13, 8).num_contradicting, 13);
}

TEST(CountContradictions, FewOutliersAndThoseOfAllFramesAreNone) {
  EXPECT_EQ(FrameWithOutliers(10, 7, 0).num_contradicting, 0);
  EXPECT_EQ(FrameWithOutliers(30, 8, 0).num_contradicting, 0);
  EXPECT_EQ(FrameWithOutliers(10, 0, 20).num_contradicting, 0);
}

TEST(CameraDoubt, RegisteredFramesWithManyOutliersCount) {
  Registration registration = RegistrationOf(0, 12);
  for (std::size_t i = 0; i < 20; ++i) registration.frames[i] = FrameWithOutliers(20, 10, 0);
  EXPECT_THAT(CameraDoubt(registration), HasSubstr("20 of 100 images"));
  registration.frames[0] = FrameWithOutliers(30, 0, 0);
  EXPECT_THAT(CameraDoubt(registration), IsEmpty());
}

TEST(CameraDoubt, FramesThatOnlyAddLittleAgree) {
  Registration registration = RegistrationOf(15, 12);
  for (std::size_t i = 15; i < 60; ++i) {
    registration.frames[i] = {};
    registration.frames[i].left_out.cause = LeftOut::Cause::kAddsLittle;
  }
  EXPECT_THAT(CameraDoubt(registration), IsEmpty());
}

TEST(CheckEnoughImages, NamesTheNumberThatIsNeeded) {
  EXPECT_NO_THROW(CheckEnoughImages(1, 1));
  ExpectThrows<DataError>([] { CheckEnoughImages(0, 1); }, {"at least one image with markers"});
  ExpectThrows<DataError>([] { CheckEnoughImages(1, 2); }, {"at least two images with markers"});
}

}  // namespace
}  // namespace velamap
