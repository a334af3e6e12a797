#include "importer/print/sheet_drawing.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/print/marker_outline.h"

namespace velamap {
namespace {

constexpr Color kPaleInk = {0.35, 0.35, 0.35};
constexpr double kHairline_mm = 0.15;
constexpr double kCutMark_mm = 2.5;
constexpr double kUprightScale_mm = 14.0;  // width that a scale beside the markers needs
constexpr double kSheetWords_mm = 3.0;     // font size

void AddCutMarks(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, Drawing* drawing) {
  for (const double x : {min_mm.x(), max_mm.x()}) {
    for (const double y : {min_mm.y(), max_mm.y()}) {
      const double out_x = x == min_mm.x() ? -kCutMark_mm : kCutMark_mm;
      const double out_y = y == min_mm.y() ? -kCutMark_mm : kCutMark_mm;
      drawing->strokes.push_back({{{x, y}, {x + out_x, y}}, kHairline_mm, kBlack});
      drawing->strokes.push_back({{{x, y}, {x, y + out_y}}, kHairline_mm, kBlack});
    }
  }
}

// Draws arrow and id on the left, and dictionary, size and place in a small font on the right.
void AddLabel(const Sticker& sticker, const PrintedLook& look, Drawing* drawing) {
  const double height = sticker.label_mm;
  const double left = sticker.min_mm.x() + 0.3 * height;
  const double right = sticker.min_mm.x() + sticker.Width() - 0.3 * height;
  const double bottom = sticker.min_mm.y() + sticker.Height() - 0.15 * height;
  const double width = right - left;
  drawing->areas.push_back(UpArrow({left + 0.3 * height, bottom}, 0.8 * height));
  drawing->texts.push_back(
      {"up", {left + 0.75 * height, bottom}, 0.4 * height, TextAnchor::kStart, false, kPaleInk});
  const Eigen::Vector2d id_place(left + 1.4 * height, bottom);
  drawing->texts.push_back({fmt::format("{}", sticker.marker.marker_id), id_place, 0.95 * height,
                            TextAnchor::kStart, true, kBlack, 0.25 * width});
  const auto write_right = [&](const std::string& text, double up) {
    const Eigen::Vector2d place(right, bottom - up);
    const double room = std::max(0.1 * width, width - 1.5 * height - 0.3 * width);
    drawing->texts.push_back({text, place, 0.42 * height, TextAnchor::kEnd, false, kBlack, room});
  };
  write_right(fmt::format("{}, {}", look.dictionary.name, LengthText(sticker.marker.length_mm)),
              0.5 * height);
  write_right(sticker.marker.place, 0.0);
}

// Draws a numbered scale from `start_mm` to the right or upwards, with ticks every millimetre up to
// 10 mm and every 10 mm from there on.
void AddScale(const Eigen::Vector2d& start_mm, int length_mm, bool is_upright, Drawing* drawing) {
  const auto at = [&](double along, double beside) -> Eigen::Vector2d {
    return start_mm +
           (is_upright ? Eigen::Vector2d(beside, -along) : Eigen::Vector2d(along, -beside));
  };
  drawing->strokes.push_back({{at(0, 0), at(length_mm, 0)}, 0.25, kBlack});
  for (int mm = 0; mm <= length_mm; ++mm) {
    if (mm > 10 && mm % 10 != 0) continue;
    const bool is_end = mm == 0 || mm == length_mm;
    const double tick_mm = is_end ? 5.0 : mm % 10 == 0 ? 3.0 : mm % 5 == 0 ? 2.2 : 1.4;
    drawing->strokes.push_back({{at(mm, 0), at(mm, tick_mm)}, kHairline_mm, kBlack});
    if (mm % 50 != 0 && mm != 10) continue;
    drawing->texts.push_back({mm == length_mm ? fmt::format("{} mm", mm) : fmt::format("{}", mm),
                              is_upright ? at(mm + 0.6, 3.4) : at(mm + 0.6, is_end ? 2.8 : 3.4),
                              2.4, TextAnchor::kStart, false, kPaleInk});
  }
}

}  // namespace

std::string LengthText(double length_mm) {
  std::string text = fmt::format("{:.3f}", length_mm);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " mm";
}

FilledArea UpArrow(const Eigen::Vector2d& foot_mm, double height_mm) {
  const auto at = [&](double right, double up) {
    return Eigen::Vector2d(foot_mm + height_mm * Eigen::Vector2d(right, -up));
  };
  return {{{at(0, 1), at(0.38, 0.5), at(0.14, 0.5), at(0.14, 0), at(-0.14, 0), at(-0.14, 0.5),
            at(-0.38, 0.5)}},
          kBlack};
}

FilledArea PrintedMarkerArea(const PrintedLook& look, int marker_id, double length_mm,
                             const Eigen::Vector2d& min_mm) {
  const cv::Mat cells = MarkerCells(look.dictionary, marker_id, look.border_bits);
  FilledArea area;
  area.outlines_mm = OutlineDarkCells(cells);
  for (std::vector<Eigen::Vector2d>& outline : area.outlines_mm) {
    for (Eigen::Vector2d& point : outline) point = min_mm + length_mm / cells.cols * point;
  }
  return area;
}

Drawing DrawPageFrame(const PageFrame& frame, const SheetWords& words, double free_left_mm) {
  Drawing drawing;
  drawing.width_mm = frame.width_mm;
  drawing.height_mm = frame.height_mm;
  const double left = frame.min_mm.x(), right = frame.max_mm.x(), width = right - left;
  const double header = frame.min_mm.y() - 4.0;
  const auto write = [&](const std::string& text, const Eigen::Vector2d& place, TextAnchor anchor,
                         bool is_bold, const Color& color, double max_width) {
    drawing.texts.push_back({text, place, kSheetWords_mm, anchor, is_bold, color, max_width});
  };
  write(words.title, {left, header}, TextAnchor::kStart, true, kPaleInk, 0.8 * width);
  write(fmt::format("{} of {}", words.sheet_number, words.num_sheets), {right, header},
        TextAnchor::kEnd, false, kPaleInk, 0.18 * width);
  const int scale_mm = width >= 112 ? 100 : width >= 62 ? 50 : 30;
  const double bottom = frame.max_mm.y() + 18.0;
  AddScale({left, bottom - 9.0}, scale_mm, false, &drawing);
  const bool has_two_scales =
      free_left_mm >= kUprightScale_mm && frame.FreeSize().y() > scale_mm + 2 * kUprightScale_mm;
  if (has_two_scales) {
    AddScale({left, frame.max_mm.y() - kUprightScale_mm}, scale_mm, true, &drawing);
  }
  write(fmt::format(
            "Print at 100 % (\"actual size\", not \"fit to page\"), then measure {} {} mm long.",
            has_two_scales ? "both scales: they have to be" : "this scale: it has to be", scale_mm),
        {left, bottom - 4.4}, TextAnchor::kStart, true, kBlack, width);
  write(
      "If not, print again at 100 %. If that does not help, change marker_length in layout.yml in "
      "the proportion of the measured to the printed length.",
      {left, bottom - 0.4}, TextAnchor::kStart, false, kBlack, width);
  return drawing;
}

Drawing DrawSheet(const Sheet& sheet, const PrintedLook& look, const SheetWords& words) {
  const double first_mm = sheet.stickers.front().min_mm.x() - kCutMark_mm;
  Drawing drawing = DrawPageFrame(sheet.frame, words, first_mm - sheet.frame.min_mm.x());
  for (const Sticker& sticker : sheet.stickers) {
    drawing.areas.push_back(PrintedMarkerArea(look, sticker.marker.marker_id,
                                              sticker.marker.length_mm, sticker.SquareMin()));
    AddLabel(sticker, look, &drawing);
    AddCutMarks(sticker.min_mm, sticker.min_mm + Eigen::Vector2d(sticker.Width(), sticker.Height()),
                &drawing);
  }
  return drawing;
}

Drawing DrawSingleMarker(const PrintedMarker& marker, const PrintedLook& look, double margin_mm) {
  Drawing drawing;
  drawing.width_mm = drawing.height_mm = marker.length_mm + 2 * margin_mm;
  drawing.areas.push_back(
      {{RectangleOutline({0, 0}, {drawing.width_mm, drawing.height_mm})}, Color{1, 1, 1}});
  drawing.areas.push_back(PrintedMarkerArea(look, marker.marker_id, marker.length_mm,
                                            Eigen::Vector2d::Constant(margin_mm)));
  return drawing;
}

}  // namespace velamap
