#include "importer/base/natural_order.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(NaturalLess, SortsNumbersByValue) {
  const std::vector<std::string> sorted = {"",
                                           "2.jpg",
                                           "10.jpg",
                                           "a",
                                           "a/1.jpg",
                                           "a/2.jpg",
                                           "a/10.jpg",
                                           "img01",
                                           "img1",
                                           "img2",
                                           "img2b3",
                                           "img2b11",
                                           "img100000000000000000000"};
  std::vector<std::string> shuffled = sorted;
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    std::sort(shuffled.begin(), shuffled.end(), NaturalLess);
    EXPECT_EQ(shuffled, sorted);
  }
}

TEST(NaturalLess, IsAStrictOrder) {
  EXPECT_FALSE(NaturalLess("a1", "a1"));
  EXPECT_NE(NaturalLess("a01", "a1"), NaturalLess("a1", "a01"));
}

}  // namespace
}  // namespace velamap
