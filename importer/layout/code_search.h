// Finds codes for marker dictionaries that differ in as many bits as possible in every rotation.

#pragma once

#include <cstdint>
#include <vector>

#include "importer/base/option.h"

namespace velamap {

// The cells inside a marker's black border. Bit `bits_per_side * row + column`, counted from the
// top left, is 1 for a white cell.
using MarkerCode = std::uint64_t;

struct CodeSet {
  int bits_per_side = 0;
  std::vector<MarkerCode> codes;  // by marker id
  int min_distance = 0;   // smallest number of bits in which two codes differ, over all rotations
  int num_symmetric = 0;  // number of codes that look the same when turned; they are the last ones
};

struct CodeSearchOptions {
  int bits_per_side = 0;  // 3 to 8; 0: no custom dictionary is made
  int num_codes = 0;      // 0: as many as the printed markers need
  bool allow_symmetric = false;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(CodeSearchOptions* options);

// The number of codes that look different in each of their four rotations; the rotations of a code
// count once.
std::int64_t NumAsymmetricCodes(int bits_per_side);

// Searches for `num_codes` codes (at least one) with a large minimum distance: a random greedy
// selection, then simulated annealing of the codes that are too close, for increasing distances. A
// code is also kept at this distance from its own rotations. Symmetric codes are taken only if
// `allow_symmetric` is set and more codes are wanted than 3x3 bits have without symmetry. The same
// options and seed give the same codes. Throws InputError if there are not enough codes.
CodeSet FindCodes(const CodeSearchOptions& options, std::uint32_t seed);

// 130 codes of 3x3 bits, the number that Maciel (2018) used on a sail and its hull: the 120 that
// look different when turned, in the order of their smallest value over the rotations, then the
// first 10 of those that look the same after half a turn.
CodeSet ThesisCodes();

}  // namespace velamap
