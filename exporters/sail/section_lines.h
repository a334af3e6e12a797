// The curves of one part's horizontal lines, and the horizontal cuts between them. Private to
// section.cc.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/section_spline.h"
#include "importer/layout/layout.h"

namespace velamap {

// Marker centres and what is known of their noise, in one place for all sections.
struct CenterSet {
  std::vector<int> marker_ids;    // ascending
  Eigen::Matrix3Xd x_m;           // by index
  Eigen::MatrixXd covariance_m2;  // 3n x 3n; rows of markers without sigma are zero
  std::vector<bool> has_sigma;

  std::optional<int> IndexOf(int marker_id) const;
  Eigen::Matrix3Xd Points(const std::vector<int>& indices) const;
  // With an empty covariance where one of them has no sigma.
  CurveData Data(const std::vector<int>& indices) const;
};

struct LineCurve {
  std::string name;
  std::vector<int> indices;  // into the CenterSet, from luff to leech
  double smoothing = 0.0;
  CurveFit fit;

  // The same with moved markers.
  SpaceCurve Refit(const CenterSet& centers) const;
};

struct MissingLine {
  std::string name;
  std::string reason;
};

struct PartCurves {
  std::vector<LineCurve> lines;  // from the lowest up
  std::vector<MissingLine> missing;
};

// Leaves out lines with too few markers, with markers in one place or not in order along the chord,
// and those that run against the others.
PartCurves FitPartLines(const LayoutPart& part, const CenterSet& centers, const Eigen::Vector3d& up,
                        int min_markers);

// "h1 and h2 cross at ..." for neighbours of which one is not above the other all along.
std::vector<std::string> FindCrossings(const std::vector<LineCurve>& lines,
                                       const Eigen::Vector3d& up);

// The cut at `height_m` along up through lines that were sampled, from the lowest up; nothing and
// why where they do not give it whole.
struct HeightCut {
  std::optional<SpaceCurve> curve;
  std::string reason;
};
HeightCut CutAtHeight(const std::vector<Eigen::Matrix3Xd>& line_points, const Eigen::Vector3d& up,
                      double height_m);

// The points that CutAtHeight joins: at equal fractions of the curve.
Eigen::Matrix3Xd SampleForCut(const SpaceCurve& line);

}  // namespace velamap
