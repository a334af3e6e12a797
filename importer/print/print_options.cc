#include "importer/print/print_options.h"

#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/text/id_ranges.h"

namespace velamap {
namespace {

const Choices<Arrangement> kArrangements = {
    {Arrangement::kMarkers, "markers"}, {Arrangement::kGrid, "grid"},
    {Arrangement::kSail, "sail"},       {Arrangement::kHull, "hull"},
    {Arrangement::kBoard, "board"},     {Arrangement::kCharuco, "charuco"}};

[[noreturn]] void ThrowSuperfluous(const std::string& option, const std::string& reason) {
  throw InputError(fmt::format("{}: {}; leave it out", option, reason));
}

// Throws for the first option that is set.
void RefuseAnyOf(std::initializer_list<std::pair<bool, std::string>> options,
                 const std::string& reason) {
  for (const auto& [is_set, option] : options) {
    if (is_set) ThrowSuperfluous(option, reason);
  }
}

}  // namespace

bool IsBoard(Arrangement arrangement) {
  return arrangement == Arrangement::kBoard || arrangement == Arrangement::kCharuco;
}

OptionGroup DescribeOptions(PrintOptions* options) {
  const auto set_ids = [options](const std::string& text, const std::string& option) {
    const auto ids = ParseIdList(text);
    if (!ids) {
      throw InputError(
          fmt::format("{}: '{}' is not a list of marker ids; give ids such as 3,17,20-25 (0 to {})",
                      option, text, kMaxMarkerId));
    }
    options->ids = *ids;
  };
  Option dictionary{
      "dictionary", &options->dictionary, "name|path",
      fmt::format("one of OpenCV's dictionaries, such as DICT_4X4_50 or DICT_APRILTAG_36h11, "
                  "THESIS_3X3_130, or a dictionary file; left out: {}",
                  kDefaultDictionary)};
  dictionary.path_use = PathUse::kReadsFile;
  return {
      "Markers",
      {Common(ChoiceOption(
           "arrangement", &options->arrangement, kArrangements,
           "markers: stickers, wherever they go; grid: stickers in rows and columns; "
           "sail: on lines of a sail; hull: on something rigid; board, charuco: one page "
           "for calibration")),
       Common({"marker_length", &options->marker_length_m, "m",
               "outer edge of the black square; board and charuco: left out, as large as fits",
               FromTo(kMinMarkerLength_m, kMaxMarkerLength_m)}),
       dictionary,
       {"border_bits", &options->border_bits, "cells", "width of the black border", FromTo(1, 8)},
       Common({"num_markers", &options->num_markers, "count",
               "number of markers, for --arrangement markers", FromTo(0, kMaxMarkerId + 1)}),
       {"first_id", &options->first_id, "id", "id of the first marker", FromTo(0, kMaxMarkerId)},
       Common({"ids", ParsedValue{&options->ids, "", set_ids}, "ids",
               "print only these markers, such as those that were lost: 3,17,20-25"})}};
}

void PrintOptions::Check() const {
  CheckRanges(*this);
  grid.Check();
  sail.Check();
  sheet.Check();
  codes.Check();
  if (layout && (!dictionary.empty() || marker_length_m || arrangement != Arrangement::kMarkers ||
                 num_markers > 0 || codes.bits_per_side > 0)) {
    ThrowSuperfluous(
        "--layout_path",
        "it cannot be combined with --arrangement, --dictionary, --marker_length, --num_markers or "
        "--CustomDictionary.bits, because the layout file describes the markers");
  }
  if (codes.bits_per_side > 0 && !dictionary.empty()) {
    ThrowSuperfluous("--dictionary", OptionName(&CodeSearchOptions::bits_per_side) + " makes one");
  }
  if (codes.bits_per_side == 0) {
    RefuseAnyOf({{codes.num_codes > 0, OptionName(&CodeSearchOptions::num_codes)},
                 {codes.allow_symmetric, OptionName(&CodeSearchOptions::allow_symmetric)}},
                OptionName(&CodeSearchOptions::bits_per_side) + " is 0, so no dictionary is made");
  }
  if (arrangement != Arrangement::kSail) {
    RefuseAnyOf({{sail.luff_m.has_value(), OptionName(&SailPlacementOptions::luff_m)},
                 {sail.foot_m.has_value(), OptionName(&SailPlacementOptions::foot_m)},
                 {sail.leech_m.has_value(), OptionName(&SailPlacementOptions::leech_m)}},
                "it is for --arrangement sail");
  }
  if (arrangement != Arrangement::kMarkers && num_markers > 0) {
    ThrowSuperfluous("--num_markers",
                     fmt::format("it is for --arrangement markers; the number of markers on a hull "
                                 "is {}",
                                 OptionName(&SailPlacementOptions::hull_markers)));
  }
  if (sail.hull_markers > 0 && (arrangement == Arrangement::kMarkers || IsBoard(arrangement))) {
    ThrowSuperfluous(OptionName(&SailPlacementOptions::hull_markers),
                     "it is for --arrangement sail, grid or hull");
  }
  if (IsBoard(arrangement)) {
    RefuseAnyOf({{!ids.empty(), "--ids"},
                 {sheet.write_svg, OptionName(&PrintSheetOptions::write_svg)},
                 {sheet.write_png, OptionName(&PrintSheetOptions::write_png)}},
                "a board is printed as a whole");
  }
}

}  // namespace velamap
