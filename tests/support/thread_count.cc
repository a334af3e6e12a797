#include "tests/support/thread_count.h"

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>

#include <gtest/gtest.h>

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

int NumThreadsOf(const std::function<void()>& work) {
  const int num_before = num_alive;
  max_num_alive = num_before;
  work();
  EXPECT_EQ(num_alive, num_before);
  return max_num_alive - num_before + 1;
}

}  // namespace velamap
