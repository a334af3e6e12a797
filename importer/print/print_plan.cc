#include "importer/print/print_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"

namespace velamap {
namespace {

constexpr int kDefaultHullMarkers = 8;

// A custom dictionary is not yet loaded here: the number of its codes depends on the planned
// markers.
PrintedLook LoadLook(const PrintOptions& options) {
  PrintedLook look;
  look.border_bits = options.layout ? options.layout->border_bits : options.border_bits;
  if (options.codes.bits_per_side > 0) return look;
  if (options.layout) {
    look.dictionary = LoadDictionary(options.layout->dictionary);
  } else {
    look.dictionary =
        LoadDictionary(options.dictionary.empty() ? kDefaultDictionary : options.dictionary);
  }
  return look;
}

int NumCells(const PrintOptions& options, const PrintedLook& look) {
  const int bits = options.codes.bits_per_side;
  return bits > 0 ? bits + 2 * look.border_bits : look.NumCells();
}

double RequireLength(const PrintOptions& options) {
  if (!options.marker_length_m) {
    throw InputError(
        "--marker_length: missing; give the outer edge of the black squares in m, such as 0.1");
  }
  return 1000 * *options.marker_length_m;
}

// Such as "sail h3, 2 of 8" or "hull"; empty for a marker without a part.
std::string PlaceText(const Layout& layout, int marker_id) {
  for (const LayoutPart& part : layout.parts) {
    for (const MarkerLine& line : part.horizontal) {
      const auto& ids = line.marker_ids;
      const auto found = std::find(ids.begin(), ids.end(), marker_id);
      if (found == ids.end()) continue;
      return fmt::format("{} {}, {} of {}", part.name, line.name, found - ids.begin() + 1,
                         ids.size());
    }
  }
  return PartOfMarker(layout, marker_id);
}

// The factor by which squares are drawn larger than the layout says. A printer that shrank the
// first squares then prints the new ones at the same size.
double DrawnOverMeasured(const PrintOptions& options) {
  constexpr double kMostOfAPrinter = 0.1;
  if (!options.layout || !options.layout->drawn_length_m) return 1.0;
  const double drawn_m = *options.layout->drawn_length_m;
  const double measured_m = options.layout->marker_length_m;
  if (std::abs(drawn_m / measured_m - 1) > kMostOfAPrinter) {
    throw InputError(
        fmt::format("--layout_path: key 'drawn_length' of {} is {} m, which no printer turns into "
                    "the {} m of 'marker_length'; give the length on the printed sheets, or leave "
                    "the key out to draw squares of 'marker_length'",
                    options.layout_path, drawn_m, measured_m));
  }
  return drawn_m / measured_m;
}

void AddMarkers(const std::vector<int>& ids, double drawn_over_measured, PrintPlan* plan) {
  for (const int id : ids) {
    plan->markers.push_back({id, 1000 * MarkerLength(plan->layout, id) * drawn_over_measured,
                             PlaceText(plan->layout, id)});
  }
}

// Adds a rigid part, which becomes the reference part. Its ids follow those of the other parts.
void AddHull(int num_markers, int first_id, PrintPlan* plan) {
  if (num_markers == 0) return;
  const std::vector<int> ids = MarkerIds(plan->layout);
  plan->layout.parts.push_back(
      RigidPart("hull", ids.empty() ? first_id : ids.back() + 1, num_markers));
  plan->layout.reference_part = "hull";
  plan->places.hull = plan->layout.parts.back();
}

void PlanPlaces(const PrintOptions& options, int num_cells, PrintPlan* plan) {
  const double length_mm = RequireLength(options);
  // The label below the margin makes a sticker higher than wide.
  const double sticker_mm = MakeSticker({0, length_mm, ""}, num_cells, options.sheet).Height();
  plan->layout = MakeLayout("", *options.marker_length_m);
  const bool is_hull = options.arrangement == Arrangement::kHull;
  if (options.arrangement == Arrangement::kSail) {
    plan->places.placement = PlaceOnSail(options.sail, length_mm, sticker_mm, options.first_id);
  } else if (options.arrangement == Arrangement::kGrid) {
    plan->places.placement = PlaceOnGrid(options.grid, length_mm, sticker_mm, options.first_id);
  }
  if (plan->places.placement) {
    plan->layout.parts.push_back(PartOfPlacement(*plan->places.placement));
  }
  const int hull_markers = options.sail.hull_markers;
  AddHull(is_hull && hull_markers == 0 ? kDefaultHullMarkers : hull_markers, options.first_id,
          plan);
  AddMarkers(MarkerIds(plan->layout), 1.0, plan);
}

// The layout has no parts, so it accepts every id.
void PlanLooseMarkers(const PrintOptions& options, PrintPlan* plan) {
  plan->layout = MakeLayout("", RequireLength(options) / 1000);
  if (options.num_markers == 0 && options.ids.empty()) {
    throw InputError(
        "--num_markers: missing; say how many markers to print, or name them by --ids");
  }
  std::vector<int> ids = options.ids;
  if (options.num_markers > 0) {
    ids.clear();
    for (int i = 0; i < options.num_markers; ++i) ids.push_back(options.first_id + i);
  }
  AddMarkers(ids, 1.0, plan);
}

void PlanOneBoard(const PrintOptions& options, int num_cells, PrintPlan* plan) {
  plan->board = PlanBoard(
      options.arrangement == Arrangement::kBoard ? BoardKind::kGrid : BoardKind::kCharuco,
      options.grid, options.sheet.paper, options.marker_length_m, num_cells, options.first_id);
  plan->layout = MakeLayout("", plan->board->length_mm / 1000);
  plan->layout.parts.push_back(RigidPart("board", options.first_id, plan->board->num_markers));
}

void PlanLayout(const PrintOptions& options, PrintPlan* plan) {
  plan->layout = *options.layout;
  std::vector<int> ids = MarkerIds(plan->layout);
  if (ids.empty()) ids = options.ids;
  if (ids.empty()) {
    throw InputError(
        "--layout_path: the layout names no markers; name those to print by --ids, such as 0,1,2");
  }
  AddMarkers(ids, DrawnOverMeasured(options), plan);
}

std::vector<int> PlannedIds(const PrintPlan& plan) {
  if (plan.board) return MarkerIds(plan.layout);
  std::vector<int> ids;
  for (const PrintedMarker& marker : plan.markers) ids.push_back(marker.marker_id);
  return ids;
}

void MakeCustomDictionary(const PrintOptions& options, int max_id, PrintPlan* plan) {
  CodeSearchOptions search = options.codes;
  if (search.num_codes == 0) search.num_codes = max_id + 1;
  plan->codes = FindCodes(search, options.seed);
  const std::string name =
      fmt::format("OWN_{}X{}_{}", search.bits_per_side, search.bits_per_side, search.num_codes);
  plan->look.dictionary = MakeDictionary(name, *plan->codes);
}

// The beginning of an error: which option requires the marker `max_id`.
std::string TooManyText(const PrintOptions& options, const std::string& option, int max_id) {
  if (options.arrangement != Arrangement::kGrid || options.layout) {
    return fmt::format("{}: marker {} is wanted", option, max_id);
  }
  return fmt::format("{}: {} rows x {} columns from id {} on{} end at marker {}",
                     OptionName(&GridPlacementOptions::num_rows), options.grid.num_rows,
                     options.grid.num_columns, options.first_id,
                     options.sail.hull_markers > 0 ? " and the markers of the hull" : "", max_id);
}

// Throws InputError for ids that no dictionary has a code for.
void CheckLargestId(const PrintOptions& options, int max_id, const PrintPlan& plan) {
  if (max_id <= kMaxMarkerId) return;
  std::string codes;
  if (!plan.look.dictionary.name.empty()) {
    codes = fmt::format(", and {} has {} codes", plan.look.dictionary.name,
                        NumMarkers(plan.look.dictionary));
  }
  throw InputError(fmt::format("{}; ids end at {}{}; give fewer markers{}",
                               TooManyText(options, "--first_id", max_id), kMaxMarkerId, codes,
                               options.codes.bits_per_side > 0
                                   ? ""
                                   : " and a dictionary with as many codes, such as "
                                     "DICT_4X4_1000 for 1000"));
}

// Throws InputError for ids that the dictionary has no code for.
void CheckIds(const PrintOptions& options, int max_id, const PrintPlan& plan) {
  const int num_codes = NumMarkers(plan.look.dictionary);
  if (max_id < num_codes) return;
  std::string option = "--dictionary", remedy = "a larger dictionary, such as DICT_4X4_1000,";
  if (plan.codes) {
    option = OptionName(&CodeSearchOptions::num_codes);
    remedy = "a larger number";
  } else if (options.layout) {
    option = fmt::format("--layout_path: key 'dictionary' of {}", options.layout_path);
  }
  throw InputError(fmt::format("{}, but {} has {} codes, 0 to {}; give {} or fewer markers",
                               TooManyText(options, option, max_id), plan.look.dictionary.name,
                               num_codes, num_codes - 1, remedy));
}

void KeepOnly(const std::vector<int>& ids, PrintPlan* plan) {
  if (ids.empty()) return;
  std::vector<PrintedMarker> kept;
  for (const int id : ids) {
    const auto found = std::find_if(plan->markers.begin(), plan->markers.end(),
                                    [id](const PrintedMarker& m) { return m.marker_id == id; });
    if (found == plan->markers.end()) {
      throw InputError(fmt::format("--ids: marker {} is not among those to print", id));
    }
    kept.push_back(*found);
  }
  plan->markers = kept;
}

}  // namespace

PrintPlan MakePrintPlan(const PrintOptions& options) {
  options.Check();
  PrintPlan plan;
  plan.look = LoadLook(options);
  const int num_cells = NumCells(options, plan.look);
  if (options.layout) {
    PlanLayout(options, &plan);
  } else if (IsBoard(options.arrangement)) {
    PlanOneBoard(options, num_cells, &plan);
  } else if (options.arrangement == Arrangement::kMarkers) {
    PlanLooseMarkers(options, &plan);
  } else {
    PlanPlaces(options, num_cells, &plan);
  }
  const std::vector<int> ids = PlannedIds(plan);
  const int max_id = *std::max_element(ids.begin(), ids.end());
  CheckLargestId(options, max_id, plan);
  if (options.codes.bits_per_side > 0) MakeCustomDictionary(options, max_id, &plan);
  CheckIds(options, max_id, plan);
  KeepOnly(options.ids, &plan);
  plan.layout.border_bits = plan.look.border_bits;
  if (!options.layout) plan.layout.drawn_length_m = plan.layout.marker_length_m;
  plan.layout.dictionary =
      IsOpenCvName(plan.look.dictionary.name) ? plan.look.dictionary.name : kDictionaryFile;
  return plan;
}

}  // namespace velamap
