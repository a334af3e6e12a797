// The rotations of a marker's code, and Hamming distances between codes.

#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "importer/layout/code_search.h"

namespace velamap {

// A code, and the same code rotated clockwise by one, two and three quarter turns.
using Rotations = std::array<MarkerCode, 4>;

inline int HammingDistance(MarkerCode a, MarkerCode b) { return __builtin_popcountll(a ^ b); }

// The smallest distance over all relative rotations.
inline int HammingDistance(const Rotations& a, const Rotations& b) {
  return std::min(std::min(HammingDistance(a[0], b[0]), HammingDistance(a[1], b[0])),
                  std::min(HammingDistance(a[2], b[0]), HammingDistance(a[3], b[0])));
}

// The smallest distance of a code from its own rotations. Three quarter turns give the same
// distance as one.
inline int DistanceToItself(const Rotations& code) {
  return std::min(HammingDistance(code[0], code[1]), HammingDistance(code[0], code[2]));
}

class CodeSpace {
 public:
  explicit CodeSpace(int bits_per_side) : size_(bits_per_side) {}

  int NumBits() const { return size_ * size_; }
  MarkerCode Mask() const { return NumBits() == 64 ? ~MarkerCode{0} : Bit(NumBits()) - 1; }
  static MarkerCode Bit(int idx) { return MarkerCode{1} << idx; }

  Rotations Turned(MarkerCode code) const {
    Rotations rotations = {code};
    for (std::size_t i = 1; i < rotations.size(); ++i) {
      rotations[i] = QuarterTurned(rotations[i - 1]);
    }
    return rotations;
  }

  // One code of each set of rotations, the smallest, in ascending order.
  std::vector<Rotations> All() const {
    std::vector<Rotations> codes;
    for (MarkerCode code = 0; code <= Mask(); ++code) {
      const Rotations rotations = Turned(code);
      if (code == *std::min_element(rotations.begin(), rotations.end())) codes.push_back(rotations);
    }
    return codes;
  }

 private:
  MarkerCode QuarterTurned(MarkerCode code) const {
    MarkerCode turned = 0;
    for (int row = 0; row < size_; ++row) {
      for (int column = 0; column < size_; ++column) {
        const MarkerCode bit = code >> (size_ * (size_ - 1 - column) + row) & 1;
        turned |= bit << (size_ * row + column);
      }
    }
    return turned;
  }

  int size_;
};

}  // namespace velamap
