#include "importer/print/drawing_writer.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kHaloOfSize = 0.4;  // width of the halo's stroke / font size
constexpr char kFontFamily[] = "sans-serif";

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;
using Context = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;

cairo_status_t Append(void* closure, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

// Text from the layout or dictionary is the only input that can be invalid. Any other failure is a
// bug in velamap.
void CheckStatus(cairo_status_t status) {
  if (status == CAIRO_STATUS_INVALID_STRING) {
    throw InputError(
        "a name in the layout or of the dictionary's file is not UTF-8; save the file as UTF-8");
  }
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::logic_error(std::string("cairo: ") + cairo_status_to_string(status));
  }
}

void SetColor(cairo_t* context, const Color& color) {
  cairo_set_source_rgb(context, color[0], color[1], color[2]);
}

void AddOutline(cairo_t* context, const std::vector<Eigen::Vector2d>& points_mm) {
  cairo_new_sub_path(context);
  for (const Eigen::Vector2d& point : points_mm) cairo_line_to(context, point.x(), point.y());
}

void DrawArea(cairo_t* context, const FilledArea& area) {
  SetColor(context, area.color);
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_WINDING);
  for (const std::vector<Eigen::Vector2d>& outline : area.outlines_mm) {
    AddOutline(context, outline);
    cairo_close_path(context);
  }
  cairo_fill(context);
}

void DrawStroke(cairo_t* context, const Stroke& stroke) {
  SetColor(context, stroke.color);
  cairo_set_line_width(context, stroke.width_mm);
  const double dashes_mm[] = {1.2, 1.0};
  cairo_set_dash(context, dashes_mm, stroke.is_dashed ? 2 : 0, 0.0);
  AddOutline(context, stroke.points_mm);
  if (stroke.is_closed) cairo_close_path(context);
  cairo_stroke(context);
}

void DrawText(cairo_t* context, const Text& text) {
  SetColor(context, text.color);
  cairo_select_font_face(context, kFontFamily, CAIRO_FONT_SLANT_NORMAL,
                         text.is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, text.size_mm);
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.text.c_str(), &extents);
  if (extents.x_advance > text.max_width_mm) {
    cairo_set_font_size(context, text.size_mm * text.max_width_mm / extents.x_advance);
    cairo_text_extents(context, text.text.c_str(), &extents);
  }
  const double part = text.anchor == TextAnchor::kStart    ? 0.0
                      : text.anchor == TextAnchor::kMiddle ? 0.5
                                                           : 1.0;
  const double left_mm = text.position_mm.x() - part * extents.x_advance;
  if (text.has_halo) {
    cairo_move_to(context, left_mm, text.position_mm.y());
    cairo_text_path(context, text.text.c_str());
    cairo_set_source_rgb(context, 1, 1, 1);
    cairo_set_line_width(context, kHaloOfSize * text.size_mm);
    cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    cairo_set_dash(context, nullptr, 0, 0.0);
    cairo_stroke(context);
    SetColor(context, text.color);
  }
  cairo_move_to(context, left_mm, text.position_mm.y());
  cairo_show_text(context, text.text.c_str());
}

void Draw(cairo_t* context, const Drawing& drawing) {
  for (const Stroke& stroke : drawing.strokes) DrawStroke(context, stroke);
  for (const FilledArea& area : drawing.areas) DrawArea(context, area);
  for (const Text& text : drawing.texts) DrawText(context, text);
}

// Without this, cairo rounds the widths of text to the pixels of a screen.
void UseExactText(cairo_t* context) {
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options);
  cairo_font_options_destroy(options);
}

void Finish(Surface surface, Context context) {
  CheckStatus(cairo_status(context.get()));
  context.reset();
  cairo_surface_finish(surface.get());
  CheckStatus(cairo_surface_status(surface.get()));
}

}  // namespace

std::string PdfBytes(const std::vector<Drawing>& pages, const std::string& title) {
  std::string bytes;
  Surface surface(cairo_pdf_surface_create_for_stream(Append, &bytes, 1, 1), cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "velamap");
  // By default, cairo writes the current time.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  Context context(cairo_create(surface.get()), cairo_destroy);
  UseExactText(context.get());
  for (const Drawing& page : pages) {
    cairo_pdf_surface_set_size(surface.get(), kPointsPerMm * page.width_mm,
                               kPointsPerMm * page.height_mm);
    cairo_save(context.get());
    cairo_scale(context.get(), kPointsPerMm, kPointsPerMm);
    Draw(context.get(), page);
    cairo_restore(context.get());
    cairo_show_page(context.get());
  }
  Finish(std::move(surface), std::move(context));
  return bytes;
}

std::string SvgText(const Drawing& drawing) {
  std::string text;
  Surface surface(
      cairo_svg_surface_create_for_stream(Append, &text, drawing.width_mm, drawing.height_mm),
      cairo_surface_destroy);
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
  Context context(cairo_create(surface.get()), cairo_destroy);
  UseExactText(context.get());
  Draw(context.get(), drawing);
  Finish(std::move(surface), std::move(context));
  return text;
}

Drawing StackDrawings(const std::vector<Drawing>& drawings) {
  Drawing stack;
  for (const Drawing& drawing : drawings) {
    const Eigen::Vector2d offset_mm(0, stack.height_mm);
    for (FilledArea area : drawing.areas) {
      for (std::vector<Eigen::Vector2d>& outline : area.outlines_mm) {
        for (Eigen::Vector2d& point : outline) point += offset_mm;
      }
      stack.areas.push_back(std::move(area));
    }
    for (Stroke stroke : drawing.strokes) {
      for (Eigen::Vector2d& point : stroke.points_mm) point += offset_mm;
      stack.strokes.push_back(std::move(stroke));
    }
    for (Text text : drawing.texts) {
      text.position_mm += offset_mm;
      stack.texts.push_back(std::move(text));
    }
    stack.width_mm = std::max(stack.width_mm, drawing.width_mm);
    stack.height_mm += drawing.height_mm;
  }
  return stack;
}

}  // namespace velamap
