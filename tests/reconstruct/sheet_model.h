// An exact model for tests: markers on a curved sheet, seen by cameras on an arc around it.

#pragma once

#include <string>
#include <vector>

#include "reconstruct/model/model.h"

namespace velamap {

struct SheetOptions {
  int num_rows = 4;  // of markers; the ids are 1, 2, ...
  int num_columns = 5;
  int num_images = 9;
  // A camera that passes by, every image nearly as the one before; else images in mixed order.
  bool time_order = false;
  CameraModel camera_model = CameraModel::kOpenCV;
};

// Every image sees every marker corner. World unit: the sheet is 3 wide, the cameras 4 away.
Model MakeSheetModel(const SheetOptions& options = {});

// Normal noise on all 2D points, px.
void AddImageNoise(double sigma_px, std::uint32_t seed, Model* model);

// Moves poses and points by normal noise of a fraction of the cameras' distance.
void PerturbSeed(double fraction, std::uint32_t seed, Model* model);

// Moves a fraction of the observations by 50 to 300 px and returns them, by point and track.
std::vector<std::pair<Point3DId, TrackElement>> AddOutliers(double fraction, std::uint32_t seed,
                                                            Model* model);

// Distances between points of the same id after the best similarity, in units of `truth`.
std::vector<double> PointErrors(const Model& model, const Model& truth);
// The largest of them.
double MaxPointError(const Model& model, const Model& truth);

// All of the model in COLMAP's binary form: equal strings are equal models.
std::string Bytes(const Model& model);

}  // namespace velamap
