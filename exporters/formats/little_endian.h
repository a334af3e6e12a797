// Numbers as bytes of binary files, least significant byte first on every machine.

#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace velamap {

template <typename T>
void AppendLittleEndian(T value, std::string* bytes) {
  static_assert(sizeof(T) == 4 || sizeof(T) == 8);
  std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t> bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (std::size_t i = 0; i < sizeof bits; ++i) {
    bytes->push_back(static_cast<char>(bits >> (8 * i)));
  }
}

}  // namespace velamap
