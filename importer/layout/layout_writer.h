// Writes a layout in the form that ReadLayout() reads.

#pragma once

#include <string>

#include "importer/layout/layout.h"

namespace velamap {

// YAML. `comment` goes before it, each of its lines behind "# ". The path of a dictionary file
// stands as it is in the layout.
std::string LayoutText(const Layout& layout, const std::string& comment);

}  // namespace velamap
