#include "importer/base/parallel.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(ParallelFor, CallsEveryIndexOnceWhateverTheThreads) {
  for (const int num_threads : {0, 1, 2, 7}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{100}}) {
      std::vector<int> num_calls(count, 0);
      ParallelFor(count, num_threads, [&](std::size_t idx) { ++num_calls[idx]; });
      EXPECT_EQ(num_calls, std::vector<int>(count, 1)) << num_threads << " threads";
    }
  }
}

TEST(ParallelFor, ThrowsWhatACallThrows) {
  for (const int num_threads : {1, 3}) {
    EXPECT_THROW(ParallelFor(50, num_threads,
                             [](std::size_t idx) {
                               if (idx == 20) throw std::runtime_error("20");
                             }),
                 std::runtime_error);
  }
}

TEST(NumThreads, ZeroMeansTheCores) {
  EXPECT_EQ(NumThreads(3), 3);
  EXPECT_GE(NumThreads(0), 1);
}

}  // namespace
}  // namespace velamap
