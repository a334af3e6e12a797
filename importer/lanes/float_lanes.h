// Groups of kLanes single-precision numbers that are processed together with the vector extension
// of GCC and Clang, which compiles to SIMD instructions on every 64-bit processor. Results have the
// same bytes on all of them, because each lane is rounded by itself and lanes are added in a fixed
// order.

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

// Attribute of a function that loops over many groups. It is compiled twice, for processors with
// AVX2 and for any 64-bit processor, and the program chooses at run time. Functions that take or
// return groups have different calling conventions in the two, so `flatten` inlines all of them;
// they have to be inline or in the same file.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VELAMAP_CLONE_FOR_AVX2 __attribute__((target_clones("avx2", "default"), flatten))
#else
#define VELAMAP_CLONE_FOR_AVX2
#endif

namespace velamap {

constexpr int kLanes = 8;
constexpr std::size_t kGroupBytes = kLanes * sizeof(float);
using Floats = float __attribute__((vector_size(kGroupBytes), aligned(kGroupBytes)));
using Ints = std::int32_t __attribute__((vector_size(kGroupBytes), aligned(kGroupBytes)));

// std::array and std::vector would lose the alignment of groups.
template <std::size_t kSize>
struct alignas(kGroupBytes) FloatsArray {
  Floats groups[kSize];

  const Floats& operator[](std::size_t index) const { return groups[index]; }
  Floats& operator[](std::size_t index) { return groups[index]; }
  const Floats* begin() const { return groups; }
  const Floats* end() const { return groups + kSize; }
  Floats* begin() { return groups; }
  Floats* end() { return groups + kSize; }
};

inline Floats AllLanes(double value) { return Floats{} + static_cast<float>(value); }
inline Floats LaneIndex() { return Floats{0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f}; }

inline Floats Min(Floats a, Floats b) { return a < b ? a : b; }
inline Floats Max(Floats a, Floats b) { return a < b ? b : a; }
inline Floats Abs(Floats x) { return Max(x, -x); }

// Correctly rounded; Eigen's square root is an approximation that differs between processors.
inline Floats Sqrt(Floats x) {
  for (int lane = 0; lane < kLanes; ++lane) x[lane] = std::sqrt(x[lane]);
  return x;
}

// Rounds towards minus infinity, for |x| < 2^31.
inline Ints Floor(Floats x) {
  const Ints truncated = __builtin_convertvector(x, Ints);
  return truncated + (x < __builtin_convertvector(truncated, Floats));  // a true lane is -1
}

inline double Sum(Floats x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

// Swaps the halves of the lanes, then the quarters, then neighbours.
template <typename Lanes>
Lanes SwapHalves(Lanes x) {
  return __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
}
template <typename Lanes>
Lanes SwapQuarters(Lanes x) {
  return __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
}
template <typename Lanes>
Lanes SwapNeighbours(Lanes x) {
  return __builtin_shufflevector(x, x, 1, 0, 3, 2, 5, 4, 7, 6);
}

template <typename Lanes>
auto MaxLane(Lanes x) {
  const auto larger = [](Lanes a, Lanes b) { return a < b ? b : a; };
  x = larger(x, SwapHalves(x));
  x = larger(x, SwapQuarters(x));
  return larger(x, SwapNeighbours(x))[0];
}
template <typename Lanes>
auto MinLane(Lanes x) {
  return -MaxLane(-x);
}

// One in the first `count` lanes, zero in the others.
inline Floats FirstLanes(int count) {
  return LaneIndex() < static_cast<float>(count) ? AllLanes(1.0) : Floats{};
}

}  // namespace velamap
