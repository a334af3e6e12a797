// The range of an option of the tools that render.

#pragma once

namespace velamap {

// Throws InputError that names the option and the range. Not a number is out of every range.
void CheckOptionRange(const char* option, double value, double min, double max);

}  // namespace velamap
