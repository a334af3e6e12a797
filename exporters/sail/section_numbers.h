// The numbers of one section curve. Private to the sections.

#pragma once

#include <array>

#include <Eigen/Core>

#include "exporters/sail/section_spline.h"

namespace velamap {

enum SectionNumber {
  kChord,  // m
  kCamber,
  kDraftPosition,
  kEntryAngle,  // deg
  kExitAngle,   // deg
  kAzimuth,     // deg, of the chord about up, from the reference direction
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

SectionNumbers ComputeNumbers(const SpaceCurve& curve, const SectionAxes& axes);

// Signed mean depth, m; its sign tells to which side the curve bulges.
double MeanDepth(const SpaceCurve& curve, const SectionAxes& axes);

// Angle from a to b about up, -180..180.
double AngleAboutDeg(const Eigen::Vector3d& up, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace velamap
