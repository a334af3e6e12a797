// Four numbers in single precision that go through the same arithmetic together: the vector
// extension of GCC and Clang, which every processor of 64 bits has instructions for. Bytes are the
// same on all of them, because each lane is rounded by itself and lanes are added in a fixed order.

#pragma once

#include <cmath>
#include <cstdint>

namespace velamap {

using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));
constexpr int kLanes = 4;

inline Floats AllLanes(double value) {
  const auto x = static_cast<float>(value);
  return Floats{x, x, x, x};
}

inline Floats Min(Floats a, Floats b) { return a < b ? a : b; }
inline Floats Max(Floats a, Floats b) { return a < b ? b : a; }
inline Floats Abs(Floats x) { return Max(x, -x); }

// Exact; Eigen's is an approximation that differs between processors.
inline Floats Sqrt(Floats x) {
  for (int lane = 0; lane < kLanes; ++lane) x[lane] = std::sqrt(x[lane]);
  return x;
}

// Towards minus infinity, for |x| < 2^31.
inline Ints Floor(Floats x) {
  const Ints truncated = __builtin_convertvector(x, Ints);
  return truncated + (x < __builtin_convertvector(truncated, Floats));  // a true lane is -1
}

inline double Sum(Floats x) { return (x[0] + x[2]) + (x[1] + x[3]); }
inline float MaxLane(Floats x) {
  const float a = x[0] < x[1] ? x[1] : x[0], b = x[2] < x[3] ? x[3] : x[2];
  return a < b ? b : a;
}

// The first `count` lanes one, the others zero.
inline Floats FirstLanes(int count) {
  return Floats{count > 0 ? 1.0f : 0.0f, count > 1 ? 1.0f : 0.0f, count > 2 ? 1.0f : 0.0f,
                count > 3 ? 1.0f : 0.0f};
}

}  // namespace velamap
