// A checksum of text that is the same on every machine.

#pragma once

#include <cstdint>
#include <string_view>

namespace velamap {

// FNV-1a, 64 bit.
inline std::uint64_t Checksum(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

}  // namespace velamap
