#include "exporters/compare/shape_alignment.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "exporters/shape/common_corners.h"
#include "exporters/shape/sail_lines.h"
#include "importer/base/error.h"
#include "importer/base/option.h"
#include "importer/geometry/alignment.h"
#include "importer/text/id_ranges.h"

namespace velamap {
namespace {

constexpr std::size_t kMinCorners = 3;
// Markers of the reference part that kAuto needs. A rotation from one or two small markers would be
// inaccurate at the far end of the sail.
constexpr int kMinAutomaticMarkers = 3;

const Choices<AlignmentMethod> kMethods = {{AlignmentMethod::kAuto, "auto"},
                                           {AlignmentMethod::kReferencePart, "reference_part"},
                                           {AlignmentMethod::kMarkers, "markers"},
                                           {AlignmentMethod::kBestFit, "best_fit"},
                                           {AlignmentMethod::kNone, "none"}};

struct Choice {
  AlignmentMethod method = AlignmentMethod::kBestFit;
  std::vector<int> marker_ids;  // empty for all markers
  std::string note;             // why the reference part was not chosen
};

std::vector<int> ReferencePartIds(const Layout& layout) {
  if (!layout.reference_part) {
    throw InputError(
        "--align reference_part: the layout names no reference_part; give a layout that does "
        "(--layout_path), or --align markers or best_fit");
  }
  return MarkersOfPart(layout, *layout.reference_part);
}

Choice ChooseAutomatically(const MarkerShape& shape, const MarkerShape& reference,
                           const Layout& layout) {
  Choice choice;
  if (!layout.reference_part) {
    choice.note = "the layout names no reference part";
    return choice;
  }
  const std::vector<int> ids = ReferencePartIds(layout);
  const auto num_common = std::count_if(ids.begin(), ids.end(), [&](int id) {
    return FindWholeMarker(shape, id) != nullptr && FindWholeMarker(reference, id) != nullptr;
  });
  if (num_common < kMinAutomaticMarkers) {
    choice.note = fmt::format("reference part '{}' has {} marker{} whole in both; {} are needed",
                              *layout.reference_part, num_common, num_common == 1 ? "" : "s",
                              kMinAutomaticMarkers);
    return choice;
  }
  choice.method = AlignmentMethod::kReferencePart;
  choice.marker_ids = ids;
  return choice;
}

std::vector<int> NamedMarkers(const MarkerShape& shape, const MarkerShape& reference,
                              const std::vector<int>& ids) {
  if (ids.empty()) {
    throw InputError("--align_markers: missing; --align markers needs ids such as 120,121,122");
  }
  for (const int id : ids) {
    const bool in_shape = FindMarker(shape, id) != nullptr;
    if (in_shape && FindMarker(reference, id) != nullptr) continue;
    throw InputError(fmt::format(
        "--align_markers: the {1} has no marker {0}; give markers that both shapes have", id,
        in_shape ? "reference" : "shape"));
  }
  return ids;
}

Choice Choose(const MarkerShape& shape, const MarkerShape& reference, const Layout& layout,
              const AlignmentOptions& options) {
  switch (options.method) {
    case AlignmentMethod::kAuto:
      return ChooseAutomatically(shape, reference, layout);
    case AlignmentMethod::kReferencePart:
      return {options.method, ReferencePartIds(layout), ""};
    case AlignmentMethod::kMarkers:
      return {options.method, NamedMarkers(shape, reference, options.marker_ids), ""};
    case AlignmentMethod::kBestFit:
    case AlignmentMethod::kNone:
      break;
  }
  return {options.method, {}, ""};
}

void CheckCorners(const CommonCorners& corners, const std::string& what) {
  if (corners.ids.size() < kMinCorners) {
    throw DataError(
        fmt::format("the shape and its reference have {} marker corners in common{}; an alignment "
                    "needs {}; check that both have the same layout",
                    corners.ids.size(), what, kMinCorners));
  }
  if (!HasSpread(corners.x_in_shape_m) || !HasSpread(corners.x_in_reference_m)) {
    throw DataError(fmt::format(
        "the corners that the shape and its reference share{} lie on one line, which does not "
        "determine the rotation about it; align by more markers",
        what));
  }
}

std::string Describe(const Choice& choice, const Layout& layout, const CommonCorners& corners) {
  std::set<int> marker_ids;
  for (const CornerId& id : corners.ids) marker_ids.insert(id.marker_id);
  const std::string size =
      fmt::format("{} corners of {} markers", corners.ids.size(), marker_ids.size());
  if (choice.method == AlignmentMethod::kReferencePart) {
    return fmt::format("part {}, {}", *layout.reference_part, size);
  }
  if (choice.method == AlignmentMethod::kMarkers) {
    return fmt::format("markers {}, {}", fmt::join(choice.marker_ids, " "), size);
  }
  return "all common corners, " + size;
}

}  // namespace

std::string AlignmentMethodName(AlignmentMethod method) { return ChoiceName(kMethods, method); }

AlignmentMethod AlignmentMethodFromName(const std::string& name, const std::string& what) {
  std::vector<std::string> names;
  for (const auto& [method, known_name] : kMethods) names.push_back(known_name);
  return kMethods[FindChoice(name, names, what)].first;
}

std::vector<int> MarkerIdsFromText(const std::string& text, const std::string& what) {
  const auto ids = ParseIdList(text);
  if (!ids) {
    throw InputError(fmt::format(
        "{}: expected a list of marker ids such as 120,121,122, found '{}'", what, text));
  }
  return *ids;
}

Alignment NoAlignment() {
  Alignment alignment;
  alignment.description = "none; both frames are taken to be the same";
  alignment.notes.push_back("the sigmas do not include the uncertainty of the frames");
  return alignment;
}

Alignment AlignShapes(const MarkerShape& shape, const MarkerShape& reference, const Layout& layout,
                      const AlignmentOptions& options) {
  if (options.method == AlignmentMethod::kNone) return NoAlignment();
  const Choice choice = Choose(shape, reference, layout, options);
  Alignment alignment;
  alignment.method = choice.method;
  if (!choice.note.empty()) alignment.notes.push_back(choice.note);
  const CommonCorners corners = FindCommonCorners(shape, reference, choice.marker_ids);
  CheckCorners(corners, choice.marker_ids.empty() ? "" : " among those to align by");
  alignment.description = Describe(choice, layout, corners);
  alignment.reference_from_shape = EstimateRigid3(corners.x_in_shape_m, corners.x_in_reference_m);
  std::vector<double> residuals_m;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const Eigen::Vector3d x = alignment.reference_from_shape * corners.x_in_shape_m[i];
    residuals_m.push_back((x - corners.x_in_reference_m[i]).norm());
    for (int axis = 0; axis < 3; ++axis) {
      alignment.equations.push_back({corners.ids[i], x, Eigen::Vector3d::Unit(axis), 1.0});
    }
  }
  alignment.residual_m = ComputeStatistics(std::move(residuals_m));
  return alignment;
}

}  // namespace velamap
