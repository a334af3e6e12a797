#include "exporters/surface/surface_trim.h"

#include <algorithm>
#include <vector>

#include <Eigen/QR>
#include <unsupported/Eigen/Splines>

#include "exporters/surface/surface_rows.h"

namespace velamap {
namespace {

constexpr int kEdgeDegree = 3;

// One parameter of the places on an edge as a function of the other.
struct OutlineCurve {
  double first = 0.0, last = 1.0;  // of the other parameter
  int degree = 0;
  Eigen::ArrayXd knots;
  Eigen::VectorXd poles;

  double At(double other) const {
    return BasisRow(knots, degree, (other - first) / (last - first), 0).row(0).dot(poles);
  }
};

enum class CurveFit { kThroughAll, kOneCubic };

// Places are (other parameter, value). Two that are nearly beside each other would make the curve
// swing; the second one is left out.
OutlineCurve FitCurve(std::vector<Eigen::Vector2d> places, CurveFit fit) {
  constexpr double kBeside = 1e-3;
  std::sort(places.begin(), places.end(),
            [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] < b[0]; });
  const auto last = std::unique(
      places.begin(), places.end(),
      [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return b[0] - a[0] < kBeside; });
  places.erase(last, places.end());
  OutlineCurve curve;
  const auto n = static_cast<Eigen::Index>(places.size());
  curve.degree = std::min<int>(kEdgeDegree, static_cast<int>(n) - 1);
  if (n > 1) {
    curve.first = places.front()[0];
    curve.last = places.back()[0];
  }
  Eigen::RowVectorXd parameters(n);
  Eigen::VectorXd values(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    parameters[k] = (places[k][0] - curve.first) / (curve.last - curve.first);
    values[k] = places[k][1];
  }
  if (fit == CurveFit::kThroughAll && curve.degree > 0) {
    Eigen::RowVectorXd knots;
    Eigen::KnotAveraging(parameters, curve.degree, knots);
    curve.knots = knots.transpose();
  } else {
    curve.knots = Eigen::ArrayXd::Zero(2 * (curve.degree + 1));
    curve.knots.tail(curve.degree + 1).setOnes();
  }
  const Eigen::MatrixXd basis =
      BasisValues(curve.knots, curve.degree, parameters.transpose().array());
  curve.poles = basis.colPivHouseholderQr().solve(values);
  return curve;
}

// Between the known places, an edge is a smooth curve in space rather than in u and v, which may
// grow unevenly. Places are (v, u) of an edge from foot to head.
std::vector<Eigen::Vector2d> FillEdge(const SplineSurface& surface,
                                      const std::vector<Eigen::Vector2d>& uvs) {
  constexpr int kPerGap = 3, kNumFootSteps = 4;
  std::vector<Eigen::Vector2d> us;
  std::vector<std::vector<Eigen::Vector2d>> coordinates(3);
  for (const Eigen::Vector2d& uv : uvs) {
    us.emplace_back(uv[1], uv[0]);
    const Eigen::Vector3d x = EvaluatePoint(surface, uv[0], uv[1]);
    for (int i = 0; i < 3; ++i) coordinates[i].emplace_back(uv[1], x[i]);
  }
  const OutlineCurve u_of_v = FitCurve(us, CurveFit::kThroughAll);
  std::vector<OutlineCurve> x_of_v;
  for (const auto& places : coordinates) x_of_v.push_back(FitCurve(places, CurveFit::kThroughAll));
  std::vector<Eigen::Vector2d> filled = {uvs.front()};
  for (std::size_t k = 1; k < uvs.size(); ++k) {
    for (int i = 1; i < kPerGap; ++i) {
      const double v = uvs[k - 1][1] + (uvs[k][1] - uvs[k - 1][1]) * i / kPerGap;
      const Eigen::Vector3d x(x_of_v[0].At(v), x_of_v[1].At(v), x_of_v[2].At(v));
      Eigen::Vector2d uv(u_of_v.At(v), v);
      for (int step = 0; step < kNumFootSteps; ++step) {
        uv += StepToFoot(EvaluateJet(surface, uv[0], uv[1]), x);
      }
      filled.push_back(uv);
    }
    filled.push_back(uvs[k]);
  }
  return filled;
}

// The parameters within the outline, first v and then u, from those of the surface.
class OutlineMap {
 public:
  OutlineMap(const SplineSurface& surface, const SurfaceOutline& outline)
      : foot_(FitCurve(outline.foot, CurveFit::kOneCubic)),
        head_(FitCurve(outline.head, CurveFit::kOneCubic)),
        luff_(FitCurve(WithinHeights(FillEdge(surface, outline.luff)), CurveFit::kThroughAll)),
        leech_(FitCurve(WithinHeights(FillEdge(surface, outline.leech)), CurveFit::kThroughAll)) {}

  Eigen::Vector2d Within(double u, double v) const {
    const double within_v = HeightWithin(u, v);
    const double first = luff_.At(within_v);
    return {(u - first) / (leech_.At(within_v) - first), within_v};
  }

  Eigen::Vector2d OnSurface(double within_u, double within_v) const {
    const double first = luff_.At(within_v);
    const double u = first + within_u * (leech_.At(within_v) - first);
    const double lowest = foot_.At(u);
    return {u, lowest + within_v * (head_.At(u) - lowest)};
  }

  // Whether opposite edges stay apart.
  bool IsOpen() const {
    constexpr int kNumSamples = 101;
    constexpr double kApart = 0.02;
    for (int k = 0; k < kNumSamples; ++k) {
      const double place = static_cast<double>(k) / (kNumSamples - 1);
      if (leech_.At(place) - luff_.At(place) < kApart) return false;
      if (head_.At(place) - foot_.At(place) < kApart) return false;
    }
    return true;
  }

 private:
  double HeightWithin(double u, double v) const {
    const double lowest = foot_.At(u);
    return (v - lowest) / (head_.At(u) - lowest);
  }

  std::vector<Eigen::Vector2d> WithinHeights(std::vector<Eigen::Vector2d> places) const {
    for (Eigen::Vector2d& uv : places) uv = {HeightWithin(uv[0], uv[1]), uv[0]};
    return places;
  }

  OutlineCurve foot_, head_, luff_, leech_;
};

// If v has a degree below three, because there are only two or three rows, raises it to cubic,
// because the outline is curved.
SplineSurface WithoutPoles(const SplineSurface& surface) {
  SplineSurface result = surface;
  if (result.degree_v < kEdgeDegree) {
    result.degree_v = kEdgeDegree;
    result.knots_v.resize(2 * (kEdgeDegree + 1) + 3);
    result.knots_v << 0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1;
  }
  return result;
}

Eigen::MatrixXd PolesFromValues(const Eigen::ArrayXd& knots, int degree,
                                const std::vector<double>& samples) {
  const Eigen::ArrayXd parameters =
      Eigen::Map<const Eigen::ArrayXd>(samples.data(), static_cast<Eigen::Index>(samples.size()));
  return BasisValues(knots, degree, parameters)
      .colPivHouseholderQr()
      .solve(Eigen::MatrixXd::Identity(parameters.size(), parameters.size()));
}

// The parameters between luff and leech at which a curve of constant height has covered these
// fractions of its length.
std::vector<double> AtFractions(const OutlineMap& map, const SplineSurface& surface,
                                double within_v, const std::vector<double>& fractions) {
  constexpr int kNumSteps = 64;
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k <= kNumSteps; ++k) {
    const Eigen::Vector2d uv = map.OnSurface(static_cast<double>(k) / kNumSteps, within_v);
    points.push_back(EvaluatePoint(surface, uv[0], uv[1]));
  }
  const std::vector<double> lengths_m = ChordLengths(points);
  std::vector<Eigen::Vector2d> places;
  for (int k = 0; k <= kNumSteps; ++k) {
    places.emplace_back(lengths_m[k] / lengths_m.back(), static_cast<double>(k) / kNumSteps);
  }
  const OutlineCurve curve = FitCurve(places, CurveFit::kThroughAll);
  std::vector<double> within_us;
  for (const double fraction : fractions) within_us.push_back(curve.At(fraction));
  return within_us;
}

// The new poles from the old ones, by least squares over samples of the new surface.
Eigen::MatrixXd PolesFromPoles(const OutlineMap& map, const SplineSurface& from,
                               const SplineSurface& to) {
  const std::vector<double> us = SpanSamples(to.knots_u), vs = SpanSamples(to.knots_v);
  const Eigen::MatrixXd by_u = PolesFromValues(to.knots_u, to.degree_u, us);
  const Eigen::MatrixXd by_v = PolesFromValues(to.knots_v, to.degree_v, vs);
  const Eigen::Index num_v = by_v.rows(), num_from = from.poles_in_shape_m.rows();
  Eigen::MatrixXd poles = Eigen::MatrixXd::Zero(by_u.rows() * num_v, num_from);
  std::vector<std::vector<double>> within_us;  // by height
  for (const double v : vs) within_us.push_back(AtFractions(map, from, v, us));
  Eigen::MatrixXd shares(vs.size(), num_from);
  for (std::size_t i = 0; i < us.size(); ++i) {
    for (std::size_t j = 0; j < vs.size(); ++j) {
      const Eigen::Vector2d uv = map.OnSurface(within_us[j][i], vs[j]);
      shares.row(static_cast<Eigen::Index>(j)) = PoleShares(from, uv[0], uv[1]);
    }
    const Eigen::MatrixXd of_column = by_v * shares;
    for (Eigen::Index pole = 0; pole < by_u.rows(); ++pole) {
      poles.middleRows(pole * num_v, num_v) += by_u(pole, static_cast<Eigen::Index>(i)) * of_column;
    }
  }
  return poles;
}

}  // namespace

void TrimToOutline(const SurfaceOutline& outline, SurfaceParameters* parameters,
                   SmoothSurface* smooth) {
  const OutlineMap map(smooth->surface, outline);
  if (!map.IsOpen()) {
    parameters->notes.push_back(
        "the edges of the cloth meet between the lines; the surface ends at the outermost ones");
    return;
  }
  SplineSurface trimmed = WithoutPoles(smooth->surface);
  const Eigen::MatrixXd from_old = PolesFromPoles(map, smooth->surface, trimmed);
  trimmed.poles_in_shape_m = from_old * smooth->surface.poles_in_shape_m;
  const auto move = [&](auto* place) {
    constexpr int kNumSteps = 6;
    const Eigen::Vector3d x = EvaluatePoint(smooth->surface, place->u, place->v);
    Eigen::Vector2d uv = map.Within(place->u, place->v);
    for (int step = 0; step < kNumSteps; ++step) {
      uv += StepToFoot(EvaluateJet(trimmed, uv[0], uv[1]), x);
    }
    place->u = uv[0];
    place->v = uv[1];
  };
  for (SurfaceObservation& observation : parameters->observations) {
    move(&observation);
    for (PlacedPoint& point : observation.points) move(&point);
  }
  smooth->surface = trimmed;
  if (smooth->pole_covariance_m2.size() == 0) return;
  smooth->pole_covariance_m2 = from_old * smooth->pole_covariance_m2 * from_old.transpose();
  smooth->smoothing_covariance_m2 =
      from_old * smooth->smoothing_covariance_m2 * from_old.transpose();
  smooth->pole_by_term = from_old * smooth->pole_by_term;
}

}  // namespace velamap
