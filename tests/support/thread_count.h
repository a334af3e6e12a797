// Counts the threads that a piece of work uses. Results do not depend on num_threads, so no other
// test would notice if the option were ignored.

#pragma once

#include <functional>

namespace velamap {

// The largest number of threads that exist at the same time, including the calling one. A thread
// exists until it is joined. Not available in builds with sanitizers, which intercept the creation
// of threads themselves.
int NumThreadsOf(const std::function<void()>& work);

}  // namespace velamap
