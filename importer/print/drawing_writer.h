// Drawings as PDF and SVG in true scale, through cairo.

#pragma once

#include <string>
#include <vector>

#include "importer/print/drawing.h"

namespace velamap {

// The bytes of a PDF file with a page for each drawing. Areas stay areas and text stays text. The
// bytes depend on the drawings, on cairo and on the installed fonts only: they hold no date.
std::string PdfBytes(const std::vector<Drawing>& pages, const std::string& title);

// The text of an SVG file whose size is given in mm.
std::string SvgText(const Drawing& drawing);

// One under the other, as wide as the widest.
Drawing StackDrawings(const std::vector<Drawing>& drawings);

}  // namespace velamap
