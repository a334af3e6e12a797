// The thesis's markers of 9 bits (section 4.1).

#pragma once

#include "importer/layout/dictionary.h"

namespace velamap {

// 3x3-bit codes: the 120 without rotational symmetry (ids 0 to 119, ascending by their bits),
// then two with 180-degree symmetry (ids 120 and 121). No bit can be corrected.
Dictionary MakeNineBitDictionary();

}  // namespace velamap
