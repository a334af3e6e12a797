// How many threads the registration and the adjustment start. Their results do not depend on it, so
// that no other test would notice an option that nobody reads.

#include <dlfcn.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>

#include <gtest/gtest.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/register_frames.h"
#include "tests/reconstruct/registration_fixture.h"
#include "tests/reconstruct/scene_model.h"

namespace {

std::atomic<int> num_alive{0};
std::atomic<int> max_num_alive{0};

template <typename Function>
Function* Original(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// These stand before the functions of the C library for all code of this program. A thread is alive
// until it is joined, so that the counts do not depend on how fast threads work.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*start)(void*), void* argument) {
  const int alive = ++num_alive;
  for (int most = max_num_alive; most < alive;) {
    if (max_num_alive.compare_exchange_weak(most, alive)) break;
  }
  return Original<decltype(pthread_create)>("pthread_create")(thread, attributes, start, argument);
}

extern "C" int pthread_join(pthread_t thread, void** result) {
  --num_alive;
  return Original<decltype(pthread_join)>("pthread_join")(thread, result);
}

namespace velamap {
namespace {

// The most threads that work at the same time, with the calling one.
template <typename Work>
int NumThreadsOf(const Work& work) {
  const int num_before = num_alive;
  max_num_alive = num_before;
  work();
  EXPECT_EQ(num_alive, num_before);
  return max_num_alive - num_before + 1;
}

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
