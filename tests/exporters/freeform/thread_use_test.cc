// How many threads the surface of a part without lines starts.

#include <random>

#include <gtest/gtest.h>

#include "tests/exporters/freeform/random_markers.h"
#include "tests/support/thread_count.h"

namespace velamap {
namespace {

TEST(FreeformThreads, AreAsManyAsAllowedAndDoNotChangeTheSurface) {
  std::mt19937 generator(7);
  const auto markers = DrawMarkers(Sphere(0.5), {0.25, 0.05, 1e-4}, &generator);
  const FreeformSurface expected = FitFreeformSurface(markers, 0.05, std::nullopt, 1);
  for (const int num_threads : {1, 2, 5}) {
    FreeformSurface surface;
    const auto fit = [&] {
      surface = FitFreeformSurface(markers, 0.05, std::nullopt, num_threads);
    };
    EXPECT_EQ(NumThreadsOf(fit), num_threads);
    EXPECT_EQ(surface.mesh.vertices_m, expected.mesh.vertices_m) << num_threads;
    EXPECT_EQ(surface.mesh.sigmas_m, expected.mesh.sigmas_m) << num_threads;
  }
}

}  // namespace
}  // namespace velamap
