// Disjoint sets of the indices 0, 1, ... (union-find).

#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace velamap {

class DisjointSets {
 public:
  // Each index is a set of its own.
  explicit DisjointSets(std::size_t num) : parents_(num) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  // The representative of the set of `i`. Shortens the paths that lead to it.
  std::size_t Find(std::size_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  // Unites two sets; the representative of the set of `a` becomes that of both.
  void Join(std::size_t a, std::size_t b) { parents_[Find(b)] = Find(a); }

 private:
  std::vector<std::size_t> parents_;
};

}  // namespace velamap
