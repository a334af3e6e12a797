#include "tests/support/render/nine_bit_dictionary.h"

#include <vector>

#include "importer/layout/code_rotations.h"

namespace velamap {

Dictionary MakeNineBitDictionary() {
  constexpr int kSize = 3, kNumSymmetric = 2;
  std::vector<MarkerCode> codes, symmetric_codes;
  for (const Rotations& code : CodeSpace(kSize).All()) {
    if (code[0] != code[2]) {
      codes.push_back(code[0]);
    } else if (code[0] != code[1] && symmetric_codes.size() < kNumSymmetric) {
      symmetric_codes.push_back(code[0]);
    }
  }
  codes.insert(codes.end(), symmetric_codes.begin(), symmetric_codes.end());
  return MakeDictionary("dictionary_3x3.yml", {kSize, codes, 1, kNumSymmetric});
}

}  // namespace velamap
