#include "importer/geometry/disjoint_sets.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(DisjointSets, JoinedOnesAreFoundUnderTheFirst) {
  DisjointSets sets(6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(sets.Find(i), i);
  sets.Join(1, 4);
  sets.Join(3, 5);
  EXPECT_EQ(sets.Find(4), 1u);
  EXPECT_NE(sets.Find(4), sets.Find(5));
  sets.Join(5, 4);  // both with all that they have been joined to
  for (const std::size_t i : {1u, 3u, 4u, 5u}) EXPECT_EQ(sets.Find(i), 3u);
  sets.Join(4, 5);
  EXPECT_EQ(sets.Find(1), 3u);
  EXPECT_EQ(sets.Find(0), 0u);
  EXPECT_EQ(sets.Find(2), 2u);
}

}  // namespace
}  // namespace velamap
