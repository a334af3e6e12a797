#include "exporters/sail/rig_numbers.h"

#include <algorithm>
#include <set>
#include <vector>

#include <Eigen/Geometry>

#include "exporters/curve/section_spline.h"

namespace velamap {
namespace {

constexpr std::size_t kMinLuffMarkers = 4;  // a smoothing spline needs as many points

enum LuffNumber { kBend, kSag, kNumLuffNumbers };

// The first markers of the lines that run from luff to leech, including lines that have too few
// markers in the layout for a section. Lines that were left out for another reason may be listed
// wrongly and are not used.
std::vector<int> FirstMarkers(const PartContext& context) {
  std::vector<int> ids;
  for (const MarkerLine& line : context.part.horizontal) {
    const auto is_line = [&](const auto& other) { return other.name == line.name; };
    const auto missing =
        std::find_if(context.curves.missing.begin(), context.curves.missing.end(), is_line);
    if (missing != context.curves.missing.end() && !missing->is_by_layout) continue;
    std::vector<int> whole;
    for (const int id : line.marker_ids) {
      if (const auto index = context.centers.IndexOf(id)) whole.push_back(*index);
    }
    if (whole.empty()) continue;
    const Eigen::Vector3d chord =
        context.centers.x_m.col(whole.back()) - context.centers.x_m.col(whole.front());
    if (whole.size() > 1 && chord.dot(context.axes.reference) <= 0) continue;
    ids.push_back(line.marker_ids.front());
  }
  return ids;
}

// Markers of the luff as indices into the MarkerCenters, from foot to head; empty if they determine
// no curve.
std::vector<int> LuffIndices(const PartContext& context) {
  const std::vector<int> first = FirstMarkers(context);
  std::set<int> ids(first.begin(), first.end());
  for (const MarkerLine& line : context.part.vertical) {
    const std::set<int> on_line(line.marker_ids.begin(), line.marker_ids.end());
    const auto num_first =
        std::count_if(first.begin(), first.end(), [&](int id) { return on_line.count(id) > 0; });
    if (num_first >= 2 && 2 * num_first >= static_cast<std::ptrdiff_t>(first.size())) {
      ids.insert(on_line.begin(), on_line.end());
    }
  }
  std::vector<int> indices;
  for (const int id : ids) {
    if (const auto index = context.centers.IndexOf(id)) indices.push_back(*index);
  }
  const auto height_m = [&](int index) {
    return context.axes.up.dot(context.centers.x_m.col(index));
  };
  std::sort(indices.begin(), indices.end(),
            [&](int a, int b) { return height_m(a) < height_m(b); });
  for (std::size_t i = 1; i < indices.size(); ++i) {
    if (height_m(indices[i]) - height_m(indices[i - 1]) < kSamePlace_m) return {};
  }
  if (indices.size() < kMinLuffMarkers) return {};
  return indices;
}

LineCurve FitLuff(const MarkerCenters& centers, const std::vector<int>& indices) {
  LineCurve luff;
  luff.indices = indices;
  const CurveData data = centers.Data(indices);
  luff.smoothing = ChooseSmoothing({data});
  luff.fit = FitCurve(data, luff.smoothing);
  return luff;
}

Eigen::VectorXd LuffNumbers(const SpaceCurve& luff, const Eigen::Vector3d& aft, int leeward) {
  const Eigen::Vector3d first = EvaluateCurve(luff, 0.0);
  const Eigen::Vector3d along = (EvaluateCurve(luff, 1.0) - first).normalized();
  const Eigen::Vector3d to_leeward = leeward * along.cross(aft).normalized();
  const Eigen::Vector3d forward = leeward * along.cross(to_leeward);
  const auto farthest = [&](const Eigen::Vector3d& direction) {
    return direction.dot(EvaluateCurve(luff, FarthestParameter(luff, direction)) - first);
  };
  Eigen::VectorXd numbers(kNumLuffNumbers);
  numbers[kBend] = farthest(forward);
  numbers[kSag] = farthest(to_leeward);
  return numbers;
}

void SetLuffNumbers(const PartContext& context, const std::optional<MarkerPair>& centerline,
                    const LineCurve* along_boat, RigNumbers* rig) {
  const MarkerCenters& centers = context.centers;
  const std::vector<int> indices = LuffIndices(context);
  if (indices.empty() || (!centerline && along_boat == nullptr)) return;
  const LineCurve luff = FitLuff(centers, indices);
  const NumbersFunction numbers = [&](const MarkerCenters& moved, int) -> Eigen::VectorXd {
    const Eigen::Vector3d aft = centerline ? Eigen::Vector3d(moved.x_m.col(centerline->last_idx) -
                                                             moved.x_m.col(centerline->first_idx))
                                           : ChordOf(along_boat->Refit(moved));
    return LuffNumbers(luff.Refit(moved), aft, context.axes.leeward);
  };
  std::set<int> moved(indices.begin(), indices.end());
  if (centerline) {
    moved.insert({centerline->first_idx, centerline->last_idx});
  } else {
    moved.insert(along_boat->indices.begin(), along_boat->indices.end());
  }
  const Eigen::VectorXd values = numbers(centers, 0);
  const Eigen::MatrixXd gradient =
      Differentiate(centers, {moved.begin(), moved.end()}, kNumLuffNumbers, numbers);
  rig->luff_bend_m = Estimate{values[kBend], SigmaOfGradient(centers, gradient.row(kBend))};
  rig->luff_sag_m = Estimate{values[kSag], SigmaOfGradient(centers, gradient.row(kSag))};
  for (const int index : indices) {
    rig->luff_marker_ids.push_back(centers.marker_ids[static_cast<std::size_t>(index)]);
  }
}

}  // namespace

RigNumbers ComputeRigNumbers(const PartContext& context,
                             const std::optional<MarkerPair>& centerline,
                             const ReferenceSection& reference, const NumbersWithGradient* foot) {
  RigNumbers rig;
  rig.part = context.part.name;
  rig.reference_section = reference.name;
  rig.aft_reference = centerline ? "centerline" : reference.Text();
  SetLuffNumbers(context, centerline,
                 reference.line_idx ? &context.curves.lines[*reference.line_idx] : nullptr, &rig);
  if (centerline && foot != nullptr) {
    const NumbersWithGradient ahead = NumbersOfPair(context, *centerline);
    rig.sheeting_angle_deg =
        Estimate{foot->numbers[kAzimuth] - ahead.numbers[kAzimuth],
                 SigmaOfGradient(context.centers,
                                 foot->gradient.row(kAzimuth) - ahead.gradient.row(kAzimuth))};
  }
  return rig;
}

}  // namespace velamap
