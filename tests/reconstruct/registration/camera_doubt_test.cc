#include "reconstruct/registration/registration.h"

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
  EXPECT_THAT(RegistrationOf(1, 3).frames.front().reason,
              HasSubstr("shares 3 of its 12 markers with the registered images; 4 are needed"));
}

TEST(CheckEnoughImages, NamesTheNumberThatIsNeeded) {
  EXPECT_NO_THROW(CheckEnoughImages(1, 1));
  ExpectThrows<DataError>([] { CheckEnoughImages(0, 1); }, {"at least one image with markers"});
  ExpectThrows<DataError>([] { CheckEnoughImages(1, 2); }, {"at least two images with markers"});
}

}  // namespace
}  // namespace velamap
