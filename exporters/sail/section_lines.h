// Curves through the horizontal lines of one part, and horizontal cuts between them. Private to the
// sections.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/section_spline.h"
#include "importer/layout/layout.h"

namespace velamap {

// Marker centers and their noise, shared by all sections.
struct CenterSet {
  std::vector<int> marker_ids;    // ascending
  Eigen::Matrix3Xd x_m;           // by index
  Eigen::MatrixXd covariance_m2;  // 3n x 3n; zero rows for markers without a sigma
  std::vector<bool> has_sigma;

  std::optional<int> IndexOf(int marker_id) const;
  Eigen::Matrix3Xd Points(const std::vector<int>& indices) const;
  // The covariance is empty if one of the markers has no sigma.
  CurveData Data(const std::vector<int>& indices) const;
};

struct LineCurve {
  std::string name;
  std::vector<int> indices;  // into the CenterSet, from luff to leech
  double smoothing = 0.0;
  CurveFit fit;

  // Fits the same line with moved markers.
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

// Fits the lines of the part. Leaves out lines with too few markers, with markers in the same place
// or out of order along the chord, and lines that run opposite to the others.
PartCurves FitPartLines(const LayoutPart& part, const CenterSet& centers, const Eigen::Vector3d& up,
                        int min_markers);

// Messages about neighboring lines that cross.
std::vector<std::string> FindCrossings(const std::vector<LineCurve>& lines,
                                       const Eigen::Vector3d& up);

// The cut at `height_m` along up through sampled lines, from the lowest up. If the lines do not
// cover the whole cut, `reason` says so.
struct HeightCut {
  std::optional<SpaceCurve> curve;
  std::string reason;
};
HeightCut CutAtHeight(const std::vector<Eigen::Matrix3Xd>& line_points, const Eigen::Vector3d& up,
                      double height_m);

// Points at equal fractions of the line, for CutAtHeight.
Eigen::Matrix3Xd SampleForCut(const SpaceCurve& line);

}  // namespace velamap
