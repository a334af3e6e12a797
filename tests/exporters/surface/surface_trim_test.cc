// A surface ends where the cloth does: along the whole luff and leech, not only somewhere.

#include "exporters/surface/surface_trim.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "exporters/surface/surface.h"
#include "importer/base/statistics.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/clip/cloth.h"
#include "tests/support/study/sail_study.h"

namespace velamap {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kNearlyExact_m = 1e-5;

double LengthAlong(const Surface& sail, double v, double from_u, double to_u) {
  constexpr int kSteps = 200;
  double length_m = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double u = from_u + (to_u - from_u) * k / kSteps;
    length_m += (sail({u + (to_u - from_u) / kSteps, v}) - sail({u, v})).norm();
  }
  return length_m;
}

// A sail with its lines and the markers on them.
struct MarkedSail {
  Surface sail;
  SailLines lines;
  SurfaceInput input;

  // From the lowest line to the highest, and `beyond` these, as a fraction of what is between them.
  Points TrueEdge(double u, double beyond = 0.0) const {
    return Sample([&](double t) { return sail({u, Height(-beyond + (1 + 2 * beyond) * t)}); });
  }
  double Height(double t) const { return lines.vs.front() + t * Span(); }
  double Span() const { return lines.vs.back() - lines.vs.front(); }

  static Points Sample(const std::function<Eigen::Vector3d(double t)>& at) {
    constexpr int kNum = 401;
    Points points;
    for (int k = 0; k < kNum; ++k) points.push_back(at(k / (kNum - 1.0)));
    return points;
  }

  double TrueArea() const {
    constexpr int kSteps = 200;
    double area_m2 = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps; ++j) {
        const auto at = [&](int di, int dj) {
          return sail({(i + di) / double{kSteps}, Height((j + dj) / double{kSteps})});
        };
        area_m2 += (at(1, 1) - at(0, 0)).cross(at(0, 1) - at(1, 0)).norm() / 2;
      }
    }
    return area_m2;
  }
};

MarkedSail MarkOut(const Surface& sail, double sigma_m, std::mt19937* random) {
  MarkedSail marked;
  marked.sail = sail;
  marked.lines = DrawLines(sail, random);
  marked.input = DrawMarkers(sail, marked.lines, sigma_m, random);
  return marked;
}

// Of the place of the line that is nearest to the middle of a marker. The corners of a marker lie
// on bent cloth, but their mean does not.
double MiddleU(const MarkedSail& marked, double v, const SurfaceMarker& marker) {
  double low = 0.0, high = 1.0;
  const auto distance_m = [&](double u) {
    return (marked.sail({u, v}) - marker.x_in_shape_m).norm();
  };
  for (int step = 0; step < 60; ++step) {
    const double third = (high - low) / 3;
    if (distance_m(low + third) < distance_m(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return (low + high) / 2;
}

void SetOffsets(MarkedSail* marked) {
  for (std::size_t j = 0; j < marked->lines.vs.size(); ++j) {
    SurfaceLine& line = marked->input.lines[j];
    const double v = marked->lines.vs[j];
    line.luff_offset_m =
        LengthAlong(marked->sail, v, 0, MiddleU(*marked, v, *line.markers.front()));
    line.leech_offset_m =
        LengthAlong(marked->sail, v, MiddleU(*marked, v, *line.markers.back()), 1);
  }
}

double DistanceFrom(const Points& line, const Eigen::Vector3d& x) {
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Eigen::Vector3d along = line[k + 1] - line[k];
    const double part = std::clamp(along.dot(x - line[k]) / along.squaredNorm(), 0.0, 1.0);
    least_m = std::min(least_m, (line[k] + part * along - x).norm());
  }
  return least_m;
}

double LargestDistanceFrom(const Points& line, const Points& points) {
  double largest_m = 0.0;
  for (const Eigen::Vector3d& x : points) largest_m = std::max(largest_m, DistanceFrom(line, x));
  return largest_m;
}

Points FoundEdge(const FittedSurface& fitted, double u) {
  return MarkedSail::Sample([&](double t) { return EvaluatePoint(fitted.surface, u, t); });
}

// Between the true edge and the one that is found, in both directions. How far up and down the
// found one reaches is for foot and head to say.
double EdgeError(const MarkedSail& marked, const FittedSurface& fitted, double u) {
  constexpr double kBeyond = 0.01;
  const Points found = FoundEdge(fitted, u);
  return std::max(LargestDistanceFrom(marked.TrueEdge(u, kBeyond), found),
                  LargestDistanceFrom(found, marked.TrueEdge(u)));
}

double EdgeError(const MarkedSail& marked, const FittedSurface& fitted) {
  return std::max(EdgeError(marked, fitted, 0), EdgeError(marked, fitted, 1));
}

void ExpectTrueArea(const MarkedSail& marked, const FittedSurface& fitted) {
  const double true_area_m2 = marked.TrueArea();
  EXPECT_NEAR(SurfaceArea(fitted.surface), true_area_m2, 0.003 * true_area_m2);
}

MarkedSail BentMainsail(double sigma_m, unsigned seed) {
  std::mt19937 random(seed);
  MarkedSail marked = MarkOut(MakeSail(Mainsail{0.85}), sigma_m, &random);
  SetOffsets(&marked);
  return marked;
}

TEST(SurfaceTrim, EndsAtTheEdgesOfTheCloth) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const MarkedSail marked = BentMainsail(kNearlyExact_m, seed);
    const FittedSurface fitted = FitSurface(marked.input);
    EXPECT_LT(EdgeError(marked, fitted), 0.002);
    ExpectTrueArea(marked, fitted);
  }
}

// Half way between two lines, only the smoothness of the edge says where it is.
TEST(SurfaceTrim, EndsAtTheEdgesOfRandomSailsWithBentLuffsAndRoach) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    MarkedSail marked = MarkOut(DrawSail(&random), kNearlyExact_m, &random);
    SetOffsets(&marked);
    const FittedSurface fitted = FitSurface(marked.input);
    EXPECT_LT(EdgeError(marked, fitted), 0.005);
    ExpectTrueArea(marked, fitted);
    for (const double u : {0.0, 1.0}) {
      const Points edge = FoundEdge(fitted, u);
      for (const double v : marked.lines.vs) {
        EXPECT_LT(DistanceFrom(edge, marked.sail({u, v})), 0.002) << v;
      }
    }
  }
}

TEST(SurfaceTrim, EndsAtTheOuterMarkersOfEachLineWithoutEdges) {
  MarkedSail marked = BentMainsail(kNearlyExact_m, 1);
  for (SurfaceLine& line : marked.input.lines) {
    line.luff_offset_m.reset();
    line.leech_offset_m.reset();
  }
  const FittedSurface fitted = FitSurface(marked.input);
  const Points luff = FoundEdge(fitted, 0), leech = FoundEdge(fitted, 1);
  for (std::size_t j = 0; j < marked.lines.vs.size(); ++j) {
    const auto& markers = marked.input.lines[j].markers;
    const double v = marked.lines.vs[j];
    const double first_u = MiddleU(marked, v, *markers.front());
    const double last_u = MiddleU(marked, v, *markers.back());
    EXPECT_LT(DistanceFrom(luff, marked.sail({first_u, v})), 0.002) << v;
    EXPECT_LT(DistanceFrom(leech, marked.sail({last_u, v})), 0.002) << v;
  }
}

TEST(SurfaceTrim, ExtensionsMeanTheSameAsOffsets) {
  MarkedSail marked = BentMainsail(0.5e-3, 2);
  for (SurfaceLine& line : marked.input.lines) line.luff_offset_m = line.leech_offset_m = 0.11;
  SurfaceOptions options;
  options.luff_extension_mm = options.leech_extension_mm = 110;
  const SplineSurface by_layout = FitSurface(marked.input).surface;
  const SplineSurface by_options = FitSurface(marked.input, options).surface;
  EXPECT_LT((by_layout.poles_in_shape_m - by_options.poles_in_shape_m).norm(), 1e-9);
}

// Points of the real edges, and markers that lie on them.
TEST(SurfaceTrim, EndsAtGivenPoints) {
  MarkedSail marked = BentMainsail(kNearlyExact_m, 3);
  SurfaceOptions options;
  options.edges.luff.points_m = marked.TrueEdge(0);
  for (const SurfaceLine& line : marked.input.lines) {
    options.edges.leech.points_m.push_back(line.markers.back()->x_in_shape_m);
  }
  const FittedSurface fitted = FitSurface(marked.input, options);
  EXPECT_LT(EdgeError(marked, fitted, 0), 0.002);
  const Points leech = FoundEdge(fitted, 1);
  for (const Eigen::Vector3d& x : options.edges.leech.points_m)
    EXPECT_LT(DistanceFrom(leech, x), 0.001);
}

// Markers along the luff that are on none of the lines, some of them beyond these.
TEST(SurfaceTrim, FollowsTheMarkersOfAnEdgeBetweenTheLines) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    MarkedSail marked = MarkOut(DrawSail(&random), kNearlyExact_m, &random);
    SetOffsets(&marked);
    std::uniform_real_distribution<double> shift(-0.3, 0.3);
    constexpr int kLast = 8;
    for (int k = 0; k <= kLast; ++k) {
      const double t = k == 0 ? -0.02 : k == kLast ? 1.02 : (k + shift(random)) / kLast;
      marked.input.edges.leech.points_m.push_back(marked.sail({1, marked.Height(t)}));
    }
    for (SurfaceLine& line : marked.input.lines) line.leech_offset_m.reset();
    const FittedSurface fitted = FitSurface(marked.input);
    const Points leech = FoundEdge(fitted, 1);
    const Points& given = marked.input.edges.leech.points_m;
    for (std::size_t k = 1; k + 1 < given.size(); ++k) {
      EXPECT_LT(DistanceFrom(leech, given[k]), 0.001);
    }
    EXPECT_LT(EdgeError(marked, fitted, 1), 0.003);
    ExpectTrueArea(marked, fitted);
  }
}

TEST(SurfaceTrim, EndsBeyondTheMarkersAlongAnEdge) {
  constexpr double kBeyond_m = 0.04;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    MarkedSail marked = BentMainsail(kNearlyExact_m, seed);
    for (SurfaceLine& line : marked.input.lines) line.luff_offset_m.reset();
    for (int k = 0; k <= 10; ++k) {
      const double v = marked.Height(k / 10.0);
      double u = 0.0;
      for (int step = 0; step < 20; ++step) {
        u += (kBeyond_m - LengthAlong(marked.sail, v, 0, u)) / LengthAlong(marked.sail, v, 0, 1);
      }
      marked.input.edges.luff.points_m.push_back(marked.sail({u, v}));
    }
    marked.input.edges.luff.beyond_m = kBeyond_m;
    EXPECT_LT(EdgeError(marked, FitSurface(marked.input)), 0.003);
  }
}

// The foot and the head of a sail are round, and the points of its layout may be a few of them.
TEST(SurfaceTrim, EndsAtPointsOfARoundFootAndHead) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    MarkedSail marked = MarkOut(DrawSail(&random), kNearlyExact_m, &random);
    SetOffsets(&marked);
    const double low = marked.lines.vs.front(), high = marked.lines.vs.back();
    const auto foot = [&](double u) { return marked.sail({u, low - 0.02 - 0.08 * u * (1 - u)}); };
    const auto head = [&](double u) { return marked.sail({u, high + 0.02 + 0.02 * u}); };
    for (const double u : {0.12, 0.37, 0.55, 0.86}) {
      marked.input.edges.foot.points_m.push_back(foot(u));
      marked.input.edges.head.points_m.push_back(head(u));
    }
    const FittedSurface fitted = FitSurface(marked.input);
    const auto found = [&](double v) {
      return MarkedSail::Sample([&](double t) { return EvaluatePoint(fitted.surface, t, v); });
    };
    EXPECT_LT(LargestDistanceFrom(found(0), MarkedSail::Sample(foot)), 0.01);
    EXPECT_LT(LargestDistanceFrom(found(1), MarkedSail::Sample(head)), 0.01);
    EXPECT_LT(LargestDistanceFrom(found(0), marked.input.edges.foot.points_m), 0.002);
    EXPECT_LT(LargestDistanceFrom(found(1), marked.input.edges.head.points_m), 0.002);
  }
}

// The foot runs as the lowest line does, not as the cloth above it spreads.
TEST(SurfaceTrim, KeepsItsDistanceFromTheOuterLines) {
  constexpr double kOffset_m = 0.15;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    MarkedSail marked = MarkOut(DrawSail(&random), kNearlyExact_m, &random);
    SetOffsets(&marked);
    marked.input.foot_offset_m = marked.input.head_offset_m = kOffset_m;
    const FittedSurface fitted = FitSurface(marked.input);
    for (const double edge : {0.0, 1.0}) {
      const double v = edge == 0 ? marked.lines.vs.front() : marked.lines.vs.back();
      const Points line = MarkedSail::Sample([&](double u) { return marked.sail({u, v}); });
      for (const double u : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        EXPECT_NEAR(DistanceFrom(line, EvaluatePoint(fitted.surface, u, edge)), kOffset_m, 0.004);
      }
    }
  }
}

// The spacing of the line says where its end is, 0.4 m beyond the last marker.
TEST(SurfaceTrim, OuterMarkersMayBeMissing) {
  MarkedSail marked = BentMainsail(kNearlyExact_m, 4);
  marked.input.lines[2].markers[0].reset();
  for (int i = 1; i <= 2; ++i) *(marked.input.lines[4].markers.rbegin() + i - 1) = std::nullopt;
  const FittedSurface fitted = FitSurface(marked.input);
  EXPECT_LT(EdgeError(marked, fitted), 0.015);
  ExpectTrueArea(marked, fitted);
}

TEST(SurfaceTrim, SigmaGrowsTowardsTheEdge) {
  const MarkedSail marked = BentMainsail(0.5e-3, 5);
  const FittedSurface fitted = FitSurface(marked.input);
  for (const double v : {0.2, 0.5, 0.8}) {
    EXPECT_GT(*SigmaAt(fitted, 0, v), 1.1 * *SigmaAt(fitted, 0.05, v));
    EXPECT_GT(*SigmaAt(fitted, 1, v), 1.1 * *SigmaAt(fitted, 0.95, v));
  }
}

// Without sigmas, another smoothness is chosen. u and v still name the same place of the cloth.
TEST(SurfaceTrim, PlacesMoveNoMoreThanTheMarkers) {
  constexpr double kMove_m = 0.5e-3;
  const MarkedSail marked = BentMainsail(kMove_m, 6);
  SurfaceInput moved = marked.input;
  std::mt19937 random(7);
  std::normal_distribution<double> noise_m(0.0, 0.5 * kMove_m);
  ForEachMarker(&moved, [&](SurfaceMarker* marker) {
    MoveMarker({noise_m(random), noise_m(random), noise_m(random)}, marker);
    marker->sigma_m.reset();
    marker->tilt_sigma_m.reset();
  });
  const SplineSurface before = FitSurface(marked.input).surface;
  const SplineSurface after = FitSurface(moved).surface;
  std::vector<double> moves_m;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const double u = i / 20.0, v = j / 20.0;
      moves_m.push_back((EvaluatePoint(after, u, v) - EvaluatePoint(before, u, v)).norm());
    }
  }
  EXPECT_LT(Rms(moves_m), 2 * kMove_m);
  EXPECT_LT(*std::max_element(moves_m.begin(), moves_m.end()), 10 * kMove_m);
}

}  // namespace
}  // namespace velamap
