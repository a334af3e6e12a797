// Codes for dictionaries of markers: sets whose members differ in as many bits as possible, however
// the markers are turned.

#pragma once

#include <cstdint>
#include <vector>

#include "importer/base/option.h"

namespace velamap {

// The cells inside a marker's black border, 1 for white: bit bits_per_side * row + column, from the
// top left.
using MarkerCode = std::uint64_t;

struct CodeSet {
  int bits_per_side = 0;
  std::vector<MarkerCode> codes;  // by marker id
  int min_distance = 0;           // the fewest bits in which two codes differ, over all rotations
  int num_symmetric = 0;          // the last ones, which look the same when turned
};

struct CodeSearchOptions {
  int bits_per_side = 0;  // 3 to 8; 0: no dictionary of one's own
  int num_codes = 0;      // 0: as many as there are markers
  bool allow_symmetric = false;

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(CodeSearchOptions* options);

// The number of codes, up to rotation, that look different in each of their four rotations.
std::int64_t NumAsymmetricCodes(int bits_per_side);

// `num_codes` codes with a distance as great as the search attains: a random greedy choice, then
// simulated annealing of the pairs that are too close, for greater and greater distances. A code is
// as far from its own rotations as from other codes. Symmetric codes are taken for 3x3 bits only,
// when all others are used. Same options and seed, same codes. Throws InputError if there are fewer
// such codes.
CodeSet FindCodes(const CodeSearchOptions& options, std::uint32_t seed);

// 130 codes of 3x3 bits, as many as Maciel (2018) stuck to a sail and its hull: the 120 that look
// different when turned, by their least value over the rotations, and the first 10 of those that
// look the same after half a turn.
CodeSet ThesisCodes();

}  // namespace velamap
