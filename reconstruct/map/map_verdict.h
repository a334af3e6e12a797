// Verdict on a finished map: its precision, and its outliers with reasons.

#pragma once

#include <string>
#include <vector>

#include "reconstruct/evidence/layout_evidence.h"
#include "reconstruct/map/map_problem.h"

namespace velamap {

// The nominal sigma is a guess; the noise of corners is at least this fraction of it.
inline constexpr double kMinNoiseFactor = 0.3;

struct MapNoise {
  // Robust standard deviation of a coordinate of a corner in units of its sigma_px: in the map, and
  // in single frames (0: not registered).
  double factor = 1.0;
  std::vector<double> factor_of_frame;  // by frame_idx
  // In all views of single markers, by marker_idx (0: too few views). It is large if the marker
  // moves relative to the others, as on a flapping leech. Without it, the views that agree with
  // each other by chance would decide its place, instead of the mean of all.
  std::vector<double> factor_of_marker;
  // The same for markers whose poses are estimated one by one: the noise of the frame's corners,
  // including blur, whether or not the frame fits the map.
  std::vector<double> single_marker_factor_of_frame;
  // The same in px, for the map and for single markers. The latter is the noise of the corners and
  // does not depend on the shape; the noise of the map is larger if the shape is wrong or the
  // surface moved.
  double sigma_px = 0.0;
  double single_marker_sigma_px = 0.0;
};

// Estimates the noise from the inliers.
MapNoise EstimateNoise(const MapProblem& problem, const MapSolution& solution);

// Largest error of an inlier of the finished map, px.
double FinalTolerance(const MapObservation& observation, const MapNoise& noise);

void MarkFinalInliers(const MapProblem& problem, const MapNoise& noise, MapSolution* solution);

// Marks also the views of a video as inliers that are outliers only because the surface moved
// (moved_views.h).
void MarkMovedViews(const MapProblem& problem, MapSolution* solution);

// Whether the errors are larger than the noise of the corners explains, which indicates a wrong
// shape.
bool IsSuspicious(const MapNoise& noise);

// The reason why an observation is not an inlier of its marker: it shows another marker, its
// corners are numbered from a wrong one, a single corner is off, or another cause.
std::string OutlierReason(const MapProblem& problem, const MapSolution& solution,
                          const MapNoise& noise, const MapObservation& observation);

// The evidence for a placed marker: where it is, how well that is known from the inliers, and how
// many of the registered frames that should show it do. Lengths in units of the map.
PlacedMarker SupportOf(const MapProblem& problem, const MapSolution& solution,
                       const MapNoise& noise, int marker_idx);

}  // namespace velamap
