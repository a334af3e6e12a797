// Work that is spread over threads. What is computed never depends on how many there are.

#pragma once

#include <cstddef>
#include <functional>

namespace velamap {

// `num_threads`, or one thread a core where it is 0. At least 1.
int NumThreads(int num_threads);

// Calls work(idx) once for every 0 <= idx < count, on up to `num_threads` threads (0: one a core),
// the calling one among them. Calls run in any order and at the same time, so each must write to
// places of its own. Where the system refuses a thread, the threads that it has given do the work.
// The first exception that a call throws is thrown again here, once all threads have ended; indices
// that no thread had taken by then are left out.
void ParallelFor(std::size_t count, int num_threads, const std::function<void(std::size_t)>& work);

}  // namespace velamap
