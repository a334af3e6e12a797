// Writes a layout in the form that ReadLayout() reads.

#pragma once

#include <string>

#include "importer/layout/layout.h"

namespace velamap {

// The YAML text, after the lines of `comment`, each with a leading "# ". The path of a dictionary
// file is written as it is in the layout.
std::string LayoutText(const Layout& layout, const std::string& comment);

}  // namespace velamap
