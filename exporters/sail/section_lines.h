// Curves through the horizontal lines of one part, and cuts at right angles to up between them.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/curve/section_spline.h"
#include "exporters/sail/section_edges.h"
#include "importer/layout/layout.h"

namespace velamap {

// Marker centres and their noise, shared by all sections.
struct MarkerCenters {
  std::vector<int> marker_ids;    // ascending
  Eigen::Matrix3Xd x_m;           // by index
  Eigen::MatrixXd covariance_m2;  // 3n x 3n; zero rows for markers without a sigma
  std::vector<bool> has_sigma;

  std::optional<int> IndexOf(int marker_id) const;
  // The covariance is empty if one of the markers has no sigma.
  CurveData Data(const std::vector<int>& indices) const;
};

struct LineCurve {
  std::string name;
  int place_in_layout = 0;   // among the part's horizontal lines
  std::vector<int> indices;  // into the MarkerCenters, from luff to leech
  double smoothing = 0.0;
  CurveFit fit;  // between the outer markers
  // From there to the edges of the cloth, where the layout gives them.
  std::optional<double> luff_offset_m{}, leech_offset_m{};
  SpaceCurve curve;  // from edge to edge

  CurveEnds Ends() const { return {luff_offset_m.value_or(0.0), leech_offset_m.value_or(0.0)}; }
  // Fits the same line with moved markers, from edge to edge.
  SpaceCurve Refit(const MarkerCenters& centers) const;
};

struct MissingLine {
  std::string name;
  std::string reason;
  bool is_by_layout = false;  // the layout itself gives the line too few markers
};

struct PartCurves {
  std::vector<LineCurve> lines;  // from the lowest up
  std::vector<MissingLine> missing;
  std::vector<std::string> crossings;  // notes, one for each pair of lines that cross
};

// Fits the lines of the part. Leaves out lines with too few markers, with markers in the same place
// or out of order along the chord, lines that run opposite to the others, and lines that cross.
PartCurves FitPartLines(const LayoutPart& part, const MarkerCenters& centers,
                        const SideEdges& edges, const Eigen::Vector3d& up, int min_markers);

// Leaves out crossing lines, the one with the most crossings first, until none cross. Of a pair
// that crosses no other line, nothing says which one is wrong, and both are left out.
//
// Two lines cross if one is above the other in one place and below it in another, compared at equal
// fractions of their lengths and as seen from the side, or if they stand in another order than the
// layout lists them, foot to head.
void LeaveOutCrossing(const Eigen::Vector3d& up, PartCurves* curves);

// Curve parameters at which lines are compared and connected.
Eigen::ArrayXd CutFractions();

// The cut at `height_m` along up through sampled lines, from the lowest up. If the lines do not
// cover the whole cut, `reason` says so.
struct HeightCut {
  std::optional<SpaceCurve> curve;
  std::string reason;
};
HeightCut CutAtHeight(const std::vector<Eigen::Matrix3Xd>& line_points, const Eigen::Vector3d& up,
                      double height_m);

// Points at CutFractions() of the line, for CutAtHeight.
Eigen::Matrix3Xd SampleForCut(const SpaceCurve& line);

// The edges to which lines go on beyond their markers: "luff and leech", one of them, or nothing.
std::string EdgesBeyondMarkers(const std::vector<LineCurve>& lines);

}  // namespace velamap
