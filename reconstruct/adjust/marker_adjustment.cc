#include "reconstruct/adjust/marker_adjustment.h"

#include <utility>

#include "reconstruct/adjust/marker_adjuster.h"
#include "reconstruct/model/turned_model.h"

namespace velamap {

MarkerAdjustmentSummary AdjustWithMarkers(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          Model* model) {
  options.Check();
  CheckModel(*model);
  Model tied = *model;
  const TurnedCameras turned = TieTurnedCameras(&tied);
  MarkerAdjuster adjuster(options, layout, corner_errors, std::move(tied));
  adjuster.PrepareSeed();
  adjuster.AdjustFromSeed();
  adjuster.RefineCalibration();
  if (adjuster.AddScaleBars()) adjuster.AdjustWithSizes();
  adjuster.AllowForMotion();
  adjuster.Finish();
  *model = adjuster.TakeModel();
  UntieTurnedCameras(turned, model);
  return adjuster.TakeSummary();
}

}  // namespace velamap
