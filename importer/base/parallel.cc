#include "importer/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <opencv2/core/utility.hpp>

namespace velamap {

void UseOwnThreadsOnly() { cv::setNumThreads(1); }

int NumThreads(int num_threads) {
  if (num_threads > 0) return num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void ParallelFor(std::size_t count, int num_threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    try {
      for (std::size_t idx = next++; idx < count; idx = next++) work(idx);
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  const std::size_t num_wanted = std::min(count, static_cast<std::size_t>(NumThreads(num_threads)));
  std::vector<std::thread> threads;
  try {
    while (threads.size() + 1 < num_wanted) threads.emplace_back(run);
  } catch (const std::system_error&) {
    // The system cannot start more threads; the others share the work.
  }
  run();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace velamap
