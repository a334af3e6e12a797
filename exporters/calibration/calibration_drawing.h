// Drawings of a calibration over its picture, as SVG elements without text.

#pragma once

#include <string>

#include "reconstruct/camera_calibration.h"

namespace velamap {

// The number of corners in each part of the picture, from white (none) to dark.
std::string DrawCoverage(const CameraCalibration& calibration);

struct ResidualDrawing {
  std::string svg;
  double magnification = 1.0;  // of the arrows
};

// All residuals as dots, and an arrow for the mean of each part of the picture, magnified so that
// the longest is about as long as a part is wide.
ResidualDrawing DrawResiduals(const CameraCalibration& calibration);

}  // namespace velamap
