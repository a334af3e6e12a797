// The numbers of one section curve, and their derivatives with respect to the marker centres for
// their sigmas.

#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/curve/section_spline.h"
#include "exporters/sail/section_lines.h"
#include "importer/layout/layout.h"

namespace velamap {

enum SectionNumber {
  kChord,  // m
  kCamber,
  kDraftPosition,
  kEntryAngle,    // deg
  kExitAngle,     // deg
  kAzimuth,       // deg, of the chord about up, from the reference direction
  kLeechAzimuth,  // deg, the same for the curve's direction at the leech
  kGirth,         // m
  kNumSectionNumbers
};
using SectionNumbers = Eigen::Matrix<double, kNumSectionNumbers, 1>;

struct SectionAxes {
  Eigen::Vector3d up;         // unit
  Eigen::Vector3d reference;  // direction of azimuth 0, not along up
  int leeward = 1;            // 1 if leeward is on the side of up x chord, otherwise -1
};

// Unit vectors along chord and depth.
struct ProfileAxes {
  Eigen::Vector3d chord, depth;
};
ProfileAxes ProfileAxesOf(const SpaceCurve& curve, const SectionAxes& axes);

// Signed mean depth, m; its sign tells to which side the curve bulges.
double MeanDepth(const SpaceCurve& curve, const SectionAxes& axes);

// Parameter of the point that is farthest from the first one along the direction, on either side.
double FarthestParameter(const SpaceCurve& curve, const Eigen::Vector3d& direction);

// Common to all sections of one part.
struct PartContext {
  const LayoutPart& part;
  const MarkerCenters& centers;
  SectionAxes axes;
  PartCurves curves;
};

// Two markers of the boom or of the centre line as indices into the MarkerCenters, from forward
// aft.
struct MarkerPair {
  int first_idx = 0, last_idx = 0;
};

struct NumbersWithGradient {
  SectionNumbers numbers;
  // One row per number, one column per coordinate of the marker centres. NaN if no marker of the
  // section has a sigma.
  Eigen::MatrixXd gradient;
  // 1 sigma of what the curvature may change beyond the outer markers: as much as between them.
  SectionNumbers beyond_sigmas = SectionNumbers::Zero();
};

NumbersWithGradient NumbersOfLine(const PartContext& context, const LineCurve& line);
// `cut` is the section at `height_m`.
NumbersWithGradient NumbersOfCut(const PartContext& context, const SpaceCurve& cut,
                                 double height_m);
// The azimuth of the pair; the other numbers are zero.
NumbersWithGradient NumbersOfPair(const PartContext& context, const MarkerPair& pair);

// Numbers as a function of the centres; only the centre with this index has moved.
using NumbersFunction = std::function<Eigen::VectorXd(const MarkerCenters& centers, int index)>;

// Their derivatives, with respect to the listed markers by central differences; zero for others.
Eigen::MatrixXd Differentiate(const MarkerCenters& centers, const std::vector<int>& indices,
                              Eigen::Index num_numbers, const NumbersFunction& function);

// Sigma of a number with this gradient; nothing if it depends on a marker without a sigma.
std::optional<double> SigmaOfGradient(const MarkerCenters& centers,
                                      const Eigen::RowVectorXd& gradient);

// Sigma of a number of a section, or of the difference from the reference's; nothing as above.
std::optional<double> SigmaOf(SectionNumber number, const MarkerCenters& centers,
                              const NumbersWithGradient& own,
                              const NumbersWithGradient* reference = nullptr);

// Points of the lines as CutAtHeight takes them.
std::vector<Eigen::Matrix3Xd> SampleLines(const std::vector<LineCurve>& lines);

}  // namespace velamap
