#include "tests/support/render/nine_bit_dictionary.h"

#include <algorithm>
#include <vector>

namespace velamap {

Dictionary MakeNineBitDictionary() {
  constexpr int kSize = 3, kNumCodes = 1 << (kSize * kSize), kNumSymmetric = 2;
  // Bit kSize * row + column of a code turned by a quarter.
  const auto turned = [](int code) {
    int result = 0;
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column) {
        const int bit = code >> (kSize * (kSize - 1 - column) + row) & 1;
        result |= bit << (kSize * row + column);
      }
    }
    return result;
  };
  std::vector<int> codes, symmetric_codes;
  for (int code = 0; code < kNumCodes; ++code) {
    const int quarter = turned(code), half = turned(quarter), three_quarters = turned(half);
    if (code > std::min({quarter, half, three_quarters})) continue;  // a turned copy is listed
    if (code != half) {
      codes.push_back(code);
    } else if (code != quarter && symmetric_codes.size() < kNumSymmetric) {
      symmetric_codes.push_back(code);
    }
  }
  codes.insert(codes.end(), symmetric_codes.begin(), symmetric_codes.end());
  cv::Mat bytes;
  for (const int code : codes) {
    cv::Mat bits(kSize, kSize, CV_8UC1);
    for (int i = 0; i < kSize * kSize; ++i) {
      bits.at<std::uint8_t>(i / kSize, i % kSize) = code >> i & 1;
    }
    bytes.push_back(cv::aruco::Dictionary::getByteListFromBits(bits));
  }
  return {"dictionary_3x3.yml", cv::makePtr<cv::aruco::Dictionary>(bytes, kSize, 0)};
}

}  // namespace velamap
