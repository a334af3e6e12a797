// The order in which people number files: frame2 before frame10.

#pragma once

#include <string>

namespace velamap {

// Compares runs of digits by value and all else byte by byte; a total order (ties, such as 01 and
// 1, are decided by plain comparison).
bool NaturalLess(const std::string& a, const std::string& b);

}  // namespace velamap
