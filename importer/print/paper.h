// Paper sizes.

#pragma once

#include <string>

namespace velamap {

struct Paper {
  std::string name;  // A4, or 210x297
  double width_mm = 210.0;
  double height_mm = 297.0;  // named papers are upright; other ones may be wider than high
};

// The allowed range of a side.
constexpr double kMinPaper_mm = 50.0, kMaxPaper_mm = 5000.0;

// Parses A0 to A6, Letter, Legal or Tabloid, in upper or lower case, or WIDTHxHEIGHT in mm, such as
// 330x480. Throws InputError that begins with `option`.
Paper ParsePaper(const std::string& text, const std::string& option);

}  // namespace velamap
