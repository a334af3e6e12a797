// Spreads work over threads. Results never depend on the number of threads.

#pragma once

#include <cstddef>
#include <functional>

namespace velamap {

// Makes OpenCV start no threads. They would compete with ours, and OpenCV's TBB throws where the
// system refuses one.
void UseOwnThreadsOnly();

// Returns `num_threads`, or the number of cores if it is 0, but at least 1.
int NumThreads(int num_threads);

// Calls work(idx) once for every 0 <= idx < count, on up to `num_threads` threads (0: one per core)
// including the calling one. The calls run in any order and in parallel, so each must write to its
// own memory. If the system refuses a thread, the threads that have started do the work. The first
// exception of a call is thrown again when all threads have ended; indices that no thread has taken
// by then are skipped.
void ParallelFor(std::size_t count, int num_threads, const std::function<void(std::size_t)>& work);

}  // namespace velamap
