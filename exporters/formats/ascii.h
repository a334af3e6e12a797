// Names for formats that allow ASCII only: STEP, IGES and DXF of AutoCAD R12.

#pragma once

#include <algorithm>
#include <string>

namespace velamap {

// Replaces each byte that is no printable ASCII character by an underscore.
inline std::string Ascii(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '_');
  return text;
}

}  // namespace velamap
