#include "reconstruct/adjust/marker_adjustment.h"

#include <optional>

#include "reconstruct/adjust/marker_adjuster.h"

namespace velamap {

MarkerAdjustmentSummary AdjustWithMarkers(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          Model* model) {
  options.Check();
  CheckModel(*model);
  MarkerAdjuster begin(options, layout, corner_errors, *model);
  begin.PrepareSeed();
  MarkerAdjuster given = begin;
  given.AdjustToCorners();
  if (given.ShowsRollingShutter()) {
    begin.FreeRollingShutter();
    given = begin;
    given.AdjustToCorners();
  }
  std::optional<MarkerAdjuster> better = given.WithBetterCalibration(begin);
  MarkerAdjuster& adjuster = better ? *better : given;
  if (adjuster.AddScaleBars()) adjuster.AdjustTightly();
  adjuster.Finish();
  *model = adjuster.TakeModel();
  return adjuster.TakeSummary();
}

}  // namespace velamap
