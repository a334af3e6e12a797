// How many threads the registration and the adjustment start.

#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/register_frames.h"
#include "tests/reconstruct/registration_fixture.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/support/thread_count.h"

namespace velamap {
namespace {

class ThreadUse : public testing::TestWithParam<int> {
 protected:
  ThreadUse() : scene_(MakeScene(SceneKind::kCube, 12, false)) {
    AddNoise({0.2, 0.0, 0.0, 200, 4}, &scene_);
  }

  int NumThreadsOfRegistration(RegistrationMethod method) const {
    RegistrationOptions options;
    options.method = method;
    options.num_threads = GetParam();
    return NumThreadsOf([&] {
      RegisterFrames(DatabaseImages(scene_), SceneCameras(scene_), scene_.layout, options);
    });
  }

  SyntheticScene scene_;
};

TEST_P(ThreadUse, GlobalRegistrationStartsAsManyAsItIsAllowed) {
  EXPECT_EQ(NumThreadsOfRegistration(RegistrationMethod::kGlobal), GetParam());
}

TEST_P(ThreadUse, RegistrationOfTheThesisStartsAsManyAsItIsAllowed) {
  EXPECT_EQ(NumThreadsOfRegistration(RegistrationMethod::kThesis), GetParam());
}

TEST_P(ThreadUse, MarkerAdjustmentStartsAsManyAsItIsAllowed) {
  MarkerAdjustmentOptions options;
  options.num_threads = GetParam();
  Model model = MakeSceneModel(scene_);
  EXPECT_EQ(NumThreadsOf([&] { AdjustWithMarkers(options, scene_.layout, {}, &model); }),
            GetParam());
}

INSTANTIATE_TEST_SUITE_P(NumThreads, ThreadUse, testing::Values(1, 2, 5));

}  // namespace
}  // namespace velamap
