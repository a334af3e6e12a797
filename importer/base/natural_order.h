// The order in which people number files: frame2 comes before frame10.

#pragma once

#include <string>

namespace velamap {

// Compares runs of digits by value and other characters byte by byte. This is a total order: plain
// comparison decides ties, such as 01 and 1.
bool NaturalLess(const std::string& a, const std::string& b);

}  // namespace velamap
