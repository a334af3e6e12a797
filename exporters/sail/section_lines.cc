#include "exporters/sail/section_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "exporters/shape/sail_lines.h"

namespace velamap {
namespace {

// The reason why no curve can be fitted to the markers; empty if one can.
std::string WhyNoCurve(const MarkerCenters& centers, const std::vector<int>& indices,
                       const Eigen::Vector3d& up) {
  constexpr double kMinSine = 0.1;  // about 6 degrees
  const Eigen::Matrix3Xd x = centers.x_m(Eigen::all, indices);
  const Eigen::Vector3d chord = x.col(x.cols() - 1) - x.col(0);
  const auto id = [&](Eigen::Index i) {
    return centers.marker_ids[static_cast<std::size_t>(indices[static_cast<std::size_t>(i)])];
  };
  if (up.cross(chord).norm() <= kMinSine * chord.norm()) {
    return "it runs upwards; list it under 'vertical'";
  }
  for (Eigen::Index i = 1; i < x.cols(); ++i) {
    const Eigen::Vector3d step = x.col(i) - x.col(i - 1);
    if (step.norm() < kSamePlace_m) {
      return fmt::format("markers {} and {} are in the same place", id(i - 1), id(i));
    }
    if (step.dot(chord) <= 0) {
      return fmt::format(
          "marker {} is not aft of marker {} between luff and leech; correct their order in the "
          "layout",
          id(i), id(i - 1));
    }
  }
  return "";
}

// How far the line goes on to luff and leech, if these are not too far.
void SetOffsets(const LayoutPart& part, const MarkerCenters& centers, const SideEdges& edges,
                const Eigen::Vector3d& up, LineCurve* line) {
  const auto line_idx = static_cast<std::size_t>(line->place_in_layout);
  const std::vector<int>& of_layout = part.horizontal[line_idx].marker_ids;
  const double longest_m = kMaxReach * ChordOf(line->fit.curve).norm();
  const auto id = [&](int index) { return centers.marker_ids[static_cast<std::size_t>(index)]; };
  const auto offset_m = [&](const SideEdge& edge, bool is_at_outer_marker, double parameter) {
    const CurveJet jet = EvaluateCurveJet(line->fit.curve, parameter);
    const Eigen::Vector3d outwards = (parameter > 0 ? 1.0 : -1.0) * jet.x_t.normalized();
    const std::optional<double> distance_m =
        DistanceToEdge(edge, {line_idx, is_at_outer_marker, jet.x, outwards}, up);
    return distance_m.value_or(0.0) <= longest_m ? distance_m : std::nullopt;
  };
  line->luff_offset_m = offset_m(edges.luff, id(line->indices.front()) == of_layout.front(), 0.0);
  line->leech_offset_m = offset_m(edges.leech, id(line->indices.back()) == of_layout.back(), 1.0);
}

// Removes lines that run opposite to the majority, or to the lowest line in a tie.
void DropReversed(const Eigen::Vector3d& up, PartCurves* curves) {
  if (curves->lines.empty()) return;
  const auto flat = [&](const LineCurve& line) -> Eigen::Vector3d {
    const Eigen::Vector3d chord = ChordOf(line.fit.curve);
    return (chord - up * up.dot(chord)).normalized();
  };
  Eigen::Vector3d sense = 0.5 * flat(curves->lines.front());
  for (const LineCurve& line : curves->lines) sense += flat(line);
  std::vector<LineCurve> kept;
  for (LineCurve& line : curves->lines) {
    if (flat(line).dot(sense) > 0) {
      kept.push_back(std::move(line));
    } else {
      curves->missing.push_back({line.name,
                                 "it runs opposite to the other lines; list its markers from luff "
                                 "to leech"});
    }
  }
  curves->lines = std::move(kept);
}

// Cumulative mean distances between neighbouring lines, normalized to 1.
Eigen::ArrayXd SpanParameters(const std::vector<Eigen::Matrix3Xd>& samples) {
  Eigen::ArrayXd parameters(static_cast<Eigen::Index>(samples.size()));
  parameters[0] = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    parameters[static_cast<Eigen::Index>(i)] =
        parameters[static_cast<Eigen::Index>(i) - 1] +
        (samples[i] - samples[i - 1]).colwise().norm().mean();
  }
  return parameters / parameters[parameters.size() - 1];
}

// Fits the lines whose markers all have a sigma, or the other lines.
void SmoothTogether(bool with_sigma, const MarkerCenters& centers, std::vector<LineCurve>* lines) {
  std::vector<LineCurve*> alike;
  std::vector<CurveData> data;
  for (LineCurve& line : *lines) {
    CurveData line_data = centers.Data(line.indices);
    if ((line_data.covariance_m2.size() > 0) != with_sigma) continue;
    alike.push_back(&line);
    data.push_back(std::move(line_data));
  }
  if (alike.empty()) return;
  const double smoothing = ChooseSmoothing(data);
  for (std::size_t i = 0; i < alike.size(); ++i) {
    alike[i]->smoothing = smoothing;
    alike[i]->fit = FitCurve(data[i], smoothing);
  }
}

}  // namespace

Eigen::ArrayXd CutFractions() {
  constexpr int kNumFractions = 25;
  return Eigen::ArrayXd::LinSpaced(kNumFractions, 0.0, 1.0);
}

std::optional<int> MarkerCenters::IndexOf(int marker_id) const {
  const auto it = std::lower_bound(marker_ids.begin(), marker_ids.end(), marker_id);
  if (it == marker_ids.end() || *it != marker_id) return std::nullopt;
  return static_cast<int>(it - marker_ids.begin());
}

CurveData MarkerCenters::Data(const std::vector<int>& indices) const {
  CurveData data{x_m(Eigen::all, indices), {}};
  std::vector<int> rows;
  for (const int index : indices) {
    if (!has_sigma[static_cast<std::size_t>(index)]) return data;
    for (int axis = 0; axis < 3; ++axis) rows.push_back(3 * index + axis);
  }
  data.covariance_m2 = covariance_m2(rows, rows);
  return data;
}

SpaceCurve LineCurve::Refit(const MarkerCenters& centers) const {
  return ExtendCurve(FitCurveOnly(centers.Data(indices), smoothing), Ends());
}

PartCurves FitPartLines(const LayoutPart& part, const MarkerCenters& centers,
                        const SideEdges& edges, const Eigen::Vector3d& up, int min_markers) {
  PartCurves curves;
  for (const MarkerLine& line : part.horizontal) {
    LineCurve curve;
    curve.name = line.name;
    curve.place_in_layout = static_cast<int>(&line - part.horizontal.data());
    for (const int marker_id : line.marker_ids) {
      if (const auto index = centers.IndexOf(marker_id)) curve.indices.push_back(*index);
    }
    if (static_cast<int>(line.marker_ids.size()) < min_markers) {
      curves.missing.push_back(
          {line.name,
           fmt::format("the layout gives it {} marker{}; {} are needed", line.marker_ids.size(),
                       line.marker_ids.size() == 1 ? "" : "s", min_markers),
           true});
      continue;
    }
    if (static_cast<int>(curve.indices.size()) < min_markers) {
      curves.missing.push_back(
          {line.name, fmt::format("{} of its {} markers are reconstructed whole; {} are needed",
                                  curve.indices.size(), line.marker_ids.size(), min_markers)});
      continue;
    }
    const std::string problem = WhyNoCurve(centers, curve.indices, up);
    if (!problem.empty()) {
      curves.missing.push_back({line.name, problem});
      continue;
    }
    curves.lines.push_back(std::move(curve));
  }
  for (const bool with_sigma : {false, true}) SmoothTogether(with_sigma, centers, &curves.lines);
  for (LineCurve& line : curves.lines) {
    SetOffsets(part, centers, edges, up, &line);
    line.curve = ExtendCurve(line.fit.curve, line.Ends());
  }
  std::stable_sort(curves.lines.begin(), curves.lines.end(),
                   [&](const LineCurve& a, const LineCurve& b) {
                     return MiddleHeight(a.fit.curve, up) < MiddleHeight(b.fit.curve, up);
                   });
  DropReversed(up, &curves);
  LeaveOutCrossing(up, &curves);
  return curves;
}

Eigen::Matrix3Xd SampleForCut(const SpaceCurve& line) {
  const Eigen::ArrayXd fractions = CutFractions();
  Eigen::Matrix3Xd points(3, fractions.size());
  for (Eigen::Index j = 0; j < fractions.size(); ++j) {
    points.col(j) = EvaluateCurve(line, fractions[j]);
  }
  return points;
}

HeightCut CutAtHeight(const std::vector<Eigen::Matrix3Xd>& line_points, const Eigen::Vector3d& up,
                      double height_m) {
  constexpr double kTolerance_m = 1e-6;  // includes the heights of the outer lines themselves
  if (line_points.size() < 2) return {std::nullopt, "fewer than two lines have a section"};
  const double lowest_m = (up.transpose() * line_points.front()).maxCoeff();
  const double highest_m = (up.transpose() * line_points.back()).minCoeff();
  if (height_m < lowest_m - kTolerance_m || height_m > highest_m + kTolerance_m) {
    return {std::nullopt, fmt::format("the lines cover whole sections only from {:.3f} to {:.3f} m",
                                      lowest_m, highest_m)};
  }
  const Interpolation across = MakeInterpolation(SpanParameters(line_points));
  const Eigen::Index num_fractions = line_points.front().cols();
  Eigen::Matrix3Xd cut(3, num_fractions);
  for (Eigen::Index j = 0; j < num_fractions; ++j) {
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(line_points.size()));
    for (std::size_t i = 0; i < line_points.size(); ++i) {
      points.col(static_cast<Eigen::Index>(i)) = line_points[i].col(j);
    }
    const SpaceCurve curve{across.degree, across.knots, points * across.poles_from_points};
    cut.col(j) = EvaluateCurve(curve, ParameterAtHeight(curve, up, height_m));
  }
  const Interpolation along = MakeInterpolation(ChordLengthParameters(cut));
  return {SpaceCurve{along.degree, along.knots, cut * along.poles_from_points}, ""};
}

std::string EdgesBeyondMarkers(const std::vector<LineCurve>& lines) {
  std::vector<const char*> edges;
  const auto add = [&](double CurveEnds::*length_m, const char* edge) {
    const bool is_beyond = std::any_of(lines.begin(), lines.end(), [&](const LineCurve& line) {
      return line.Ends().*length_m > 0;
    });
    if (is_beyond) edges.push_back(edge);
  };
  add(&CurveEnds::before_m, "luff");
  add(&CurveEnds::after_m, "leech");
  return fmt::format("{}", fmt::join(edges, " and "));
}

}  // namespace velamap
