// The threads that fit samples.

#pragma once

#include <functional>

namespace velamap {

struct FitWorkers {
  int num_threads = 1;           // 0: one per core
  std::function<void()> on_fit;  // called after each fit of a sample, from any thread; may be empty
};

}  // namespace velamap
