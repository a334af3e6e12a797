#include "reconstruct/adjust/marker_adjustment.h"

#include <optional>
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
  MarkerAdjuster begin(options, layout, corner_errors, std::move(tied));
  begin.PrepareSeed();
  MarkerAdjuster given = MarkerAdjuster::AdjustedFrom(&begin);
  std::optional<MarkerAdjuster> better = given.WithBetterCalibration(begin);
  MarkerAdjuster& adjuster = better ? *better : given;
  if (adjuster.AddScaleBars()) adjuster.AdjustWithSizes();
  adjuster.AllowForMotion();
  adjuster.Finish();
  *model = adjuster.TakeModel();
  UntieTurnedCameras(turned, model);
  return adjuster.TakeSummary();
}

}  // namespace velamap
