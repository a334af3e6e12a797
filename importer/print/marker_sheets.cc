#include "importer/print/marker_sheets.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/replacement.h"
#include "importer/layout/layout_writer.h"
#include "importer/print/drawing_writer.h"
#include "importer/print/png_file.h"
#include "importer/print/print_plan.h"

namespace velamap {
namespace {

// Contents of the files by path relative to the folder, such as markers/marker_0012.svg.
using OutputFiles = std::map<std::string, std::string>;

std::vector<Drawing> DrawSheets(const std::vector<Sheet>& sheets, const PrintedLook& look) {
  std::vector<Drawing> pages;
  for (const Sheet& sheet : sheets) {
    const double length_mm = sheet.stickers.front().marker.length_mm;
    pages.push_back(DrawSheet(
        sheet, look,
        {fmt::format("{}, black squares of {}", look.dictionary.name, LengthText(length_mm)),
         static_cast<int>(pages.size()) + 1, static_cast<int>(sheets.size())}));
  }
  return pages;
}

void WarnOfNarrowMargin(const PrintSheetOptions& options, const PrintPlan& plan) {
  if (!options.margin_mm || plan.markers.empty()) return;
  double default_mm = 0.0;
  for (const PrintedMarker& marker : plan.markers) {
    default_mm = std::max(default_mm, DefaultMargin(marker.length_mm, plan.look.NumCells()));
  }
  if (*options.margin_mm >= default_mm) return;
  LogWarning(
      "{}: a white margin of {:.4g} mm is narrow: a dark background shifts the corners of markers "
      "that are small in the images; {:.4g} mm or more avoid that",
      OptionName(&PrintSheetOptions::margin_mm), *options.margin_mm, default_mm);
}

// A length such as 99.5 mm was measured rather than chosen. The printer that made 99.5 mm of 100 mm
// would make 99 mm of 99.5 mm.
void WarnOfMeasuredLength(const PrintOptions& options) {
  constexpr double kLeast_mm = 10.0;  // shorter ones are often chosen to a tenth
  if (!options.layout || options.layout->drawn_length_m) return;
  const double length_mm = 1000 * options.layout->marker_length_m;
  if (length_mm < kLeast_mm || std::abs(length_mm - std::round(length_mm)) < 1e-6) return;
  LogWarning(
      "--layout_path: the squares are drawn with the {:.5g} mm of key 'marker_length'. If you "
      "corrected it by the scale on sheets, add the length that those were drawn with, such as "
      "'drawn_length: {:g}' (m), to {}, or the printer changes the size a second time",
      length_mm, std::round(length_mm) / 1000, options.layout_path);
}

void AddSingleMarkers(const PrintPlan& plan, const PrintSheetOptions& options, OutputFiles* files) {
  for (const PrintedMarker& marker : plan.markers) {
    const double margin_mm = MakeSticker(marker, plan.look.NumCells(), options).margin_mm;
    const std::string name = fmt::format("markers/marker_{:04d}", marker.marker_id);
    if (options.write_svg) {
      (*files)[name + ".svg"] = SvgText(DrawSingleMarker(marker, plan.look, margin_mm));
    }
    if (options.write_png) {
      (*files)[name + ".png"] =
          MarkerPng(MarkerCells(plan.look.dictionary, marker.marker_id, plan.look.border_bits),
                    marker.length_mm, margin_mm, options.png_dpi);
    }
  }
}

std::string LayoutComment(const PrintOptions& options, const PrintPlan& plan) {
  std::string comment = fmt::format(
      "Written by velamap marker_generator, to start from: correct what is different on your "
      "object.\n{}\nLeave drawn_length as it is: sheets that you print later follow from both.",
      kLengthFromScale);
  if (plan.board) {
    comment +=
        fmt::format("\n{} columns, {} rows, {} {}.", plan.board->num_columns, plan.board->num_rows,
                    LengthText(plan.board->spacing_mm),
                    plan.board->kind == BoardKind::kCharuco ? "a square" : "between centres");
  }
  if (options.arrangement == Arrangement::kSail && !options.layout) {
    comment += fmt::format("\nSail: luff {} m, foot {} m, leech {} m.", *options.sail.luff_m,
                           *options.sail.foot_m, *options.sail.leech_m);
  }
  return comment;
}

// Adds layout and dictionary. If a layout is printed, the user already has both.
void AddLayout(const PrintOptions& options, const PrintPlan& plan, OutputFiles* files) {
  if (options.layout) return;
  (*files)["layout.yml"] = LayoutText(plan.layout, LayoutComment(options, plan));
  if (!IsOpenCvName(plan.look.dictionary.name)) {
    (*files)[kDictionaryFile] = DictionaryText(plan.look.dictionary);
  }
}

void WriteFiles(const OutputFiles& files, const std::string& output_path) {
  AtomicFolder folder(output_path);
  for (const auto& [name, content] : files) {
    const std::filesystem::path path = folder.TemporaryPath() / name;
    CreateFolders(path.parent_path());
    WriteFile(path, [&text = content](std::ostream& out) { out << text; });
  }
  folder.Commit();
}

}  // namespace

PrintReport PrintMarkers(const PrintOptions& options, const std::string& output_path) {
  CheckReplaceableFolder(output_path);
  const PrintPlan plan = MakePrintPlan(options);
  WarnOfNarrowMargin(options.sheet, plan);
  WarnOfMeasuredLength(options);
  PrintReport report;
  report.dictionary = plan.look.dictionary.name;
  report.num_codes = NumMarkers(plan.look.dictionary);
  report.codes = plan.codes;
  if (options.layout && options.layout->drawn_length_m != options.layout->marker_length_m &&
      options.layout->drawn_length_m) {
    report.drawn_length_mm = 1000 * *options.layout->drawn_length_m;
  }
  OutputFiles files;
  std::vector<Drawing> pages, sheets;
  if (plan.board) {
    sheets = {DrawBoard(*plan.board, plan.look, {"velamap calibration board", 1, 1})};
    files["board.svg"] = SvgText(sheets.front());
    report.num_markers = plan.board->num_markers;
  } else {
    const std::vector<Sheet> planned =
        PlanSheets(plan.markers, plan.look.NumCells(), options.sheet);
    sheets = DrawSheets(planned, plan.look);
    report.num_markers = static_cast<int>(plan.markers.size());
    report.margin_mm = planned.front().stickers.front().margin_mm;
  }
  if (plan.places.placement || plan.places.hull) {
    pages = DrawPlacement(plan.places, options.sheet.paper);
    files["placement.svg"] = SvgText(StackDrawings(pages));
  }
  report.num_sheets = static_cast<int>(sheets.size());
  report.num_drawings = static_cast<int>(pages.size());
  pages.insert(pages.end(), sheets.begin(), sheets.end());
  files["sheets.pdf"] = PdfBytes(pages, "Markers for velamap, " + plan.look.dictionary.name);
  AddLayout(options, plan, &files);
  AddSingleMarkers(plan, options.sheet, &files);
  WriteFiles(files, output_path);
  for (const auto& [name, content] : files) report.files.push_back(name);
  return report;
}

}  // namespace velamap
