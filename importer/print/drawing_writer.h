// Writes drawings as PDF and SVG in true scale, with cairo. PdfBytes() and SvgText() throw
// InputError for text that is not UTF-8.

#pragma once

#include <string>
#include <vector>

#include "importer/print/drawing.h"

namespace velamap {

// The bytes of a PDF file with one page per drawing, as vector graphics and text. They depend only
// on the drawings, the version of cairo and the installed fonts, and contain no date.
std::string PdfBytes(const std::vector<Drawing>& pages, const std::string& title);

// The text of an SVG file that states its size in mm.
std::string SvgText(const Drawing& drawing);

// One drawing with the given ones below each other, as wide as the widest of them.
Drawing StackDrawings(const std::vector<Drawing>& drawings);

}  // namespace velamap
