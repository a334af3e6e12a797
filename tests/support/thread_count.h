// How many threads some work starts. Results do not depend on it, so that no other test would
// notice an option num_threads that nobody reads.

#pragma once

#include <functional>

namespace velamap {

// The most threads that work at the same time, with the calling one. The sanitizers count threads
// themselves, so that their builds cannot have this.
int NumThreadsOf(const std::function<void()>& work);

}  // namespace velamap
