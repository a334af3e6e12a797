// The numbers of one section curve, and how they depend on the markers. Private to section.cc and
// section_lines.cc.

#pragma once

#include <array>

#include <Eigen/Core>

#include "exporters/sail/section_spline.h"

namespace velamap {

enum SectionNumber {
  kChord,  // m
  kCamber,
  kDraftPosition,
  kEntryAngle,  // deg, to the side of up x chord
  kExitAngle,   // deg
  kAzimuth,     // deg, of the chord about up, from a reference direction
  kNumSectionNumbers
};
using SectionNumbers = Eigen::Matrix<double, kNumSectionNumbers, 1>;

struct SectionAxes {
  Eigen::Vector3d up;         // unit
  Eigen::Vector3d reference;  // from which azimuths count, not along up
  int leeward = 1;            // 1: depth counts along up x chord, -1: against it
};

// Unit vectors of the chord and of the depth.
struct ProfileAxes {
  Eigen::Vector3d chord, depth;
};
ProfileAxes ProfileAxesOf(const SpaceCurve& curve, const SectionAxes& axes);

SectionNumbers ComputeNumbers(const SpaceCurve& curve, const SectionAxes& axes);

// Mean of the depths, m, with their sign: tells on which side the curve bulges.
double MeanDepth(const SpaceCurve& curve, const SectionAxes& axes);

// Of b against a about up, -180..180.
double AngleAboutDeg(const Eigen::Vector3d& up, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace velamap
