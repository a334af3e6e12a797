#include "importer/blurred_cells.h"

#include <algorithm>

#include "importer/normal_table.h"

namespace velamap {
namespace {

// std::floor is a call where the processor's own rounding may not be used. |x| stays small here.
int Floor(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < truncated);
}

}  // namespace

void ComputeShares(double x, double blur, int num_cells, Shares* shares) {
  constexpr double kReach = 3.3;  // sigmas
  // Edge k lies between the ringed cells k and k + 1.
  const int last_edge = num_cells + 2 * kRing - 2;
  const double place = x + kRing - 1;
  const int low = std::clamp(-Floor(kReach * blur - place), 0, last_edge + 1);
  const int high = std::clamp(Floor(place + kReach * blur), -1, last_edge);
  shares->first = low;
  shares->blur = blur;
  shares->count = std::max(high - low + 2, 1);
  const double inverse_blur = 1 / blur;
  // What one edge leaves, the next takes.
  double distribution = 1.0, density = 0.0, moment = 0.0;
  const int num_edges = shares->count - 1;
  for (int i = 0; i < num_edges; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const double z = (place - (low + i)) * inverse_blur;
    const NormalTable::Value normal = kNormalTable.At(z);
    const double next_density = normal.density * inverse_blur;
    const double next_moment = -z * next_density;
    shares->value[index] = distribution - normal.distribution;
    shares->by_x[index] = density - next_density;
    shares->by_blur[index] = moment - next_moment;
    distribution = normal.distribution;
    density = next_density;
    moment = next_moment;
  }
  const auto last = static_cast<std::size_t>(num_edges);
  shares->value[last] = distribution;
  shares->by_x[last] = density;
  shares->by_blur[last] = moment;
}

bool Reaches(int num_rings, const Shares& shares, int num_cells) {
  return shares.first < num_rings ||
         shares.first + shares.count > num_cells + 2 * kRing - num_rings;
}

Blended Blend(const Lightness& lightness, const Shares& u, const Shares& v) {
  Blended sum;
  double by_blur_u_v = 0.0;
  for (int j = 0; j < v.count; ++j) {
    double value = 0.0, by_u = 0.0, by_blur_u = 0.0;
    const double* row = &lightness(v.first + j, u.first);
    for (int i = 0; i < u.count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      value += row[i] * u.value[index];
      by_u += row[i] * u.by_x[index];
      by_blur_u += row[i] * u.by_blur[index];
    }
    const auto index = static_cast<std::size_t>(j);
    sum.value += value * v.value[index];
    sum.by_u += by_u * v.value[index];
    sum.by_blur_u += by_blur_u * v.value[index];
    sum.by_v += value * v.by_x[index];
    sum.by_blur_v += value * v.by_blur[index];
    sum.by_u_v += by_u * v.by_x[index];
    by_blur_u_v += by_blur_u * v.by_blur[index];
  }
  sum.by_uu_vv = by_blur_u_v / (u.blur * v.blur);  // for a Gaussian, d/dblur = blur d2/dx2
  return sum;
}

double BlendValue(const Lightness& lightness, const Shares& u, const Shares& v) {
  double sum = 0.0;
  for (int j = 0; j < v.count; ++j) {
    double value = 0.0;
    const double* row = &lightness(v.first + j, u.first);
    for (int i = 0; i < u.count; ++i) value += row[i] * u.value[static_cast<std::size_t>(i)];
    sum += value * v.value[static_cast<std::size_t>(j)];
  }
  return sum;
}

void Add(double factor, const Blended& a, Blended* b) {
  b->value += factor * a.value;
  b->by_u += factor * a.by_u;
  b->by_v += factor * a.by_v;
  b->by_blur_u += factor * a.by_blur_u;
  b->by_blur_v += factor * a.by_blur_v;
  b->by_u_v += factor * a.by_u_v;
  b->by_uu_vv += factor * a.by_uu_vv;
}

void AddCorrelation(double covariance, Blended* blended) {
  blended->value +=
      covariance * blended->by_u_v + 0.5 * covariance * covariance * blended->by_uu_vv;
}

}  // namespace velamap
