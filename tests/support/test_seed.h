// Seed of a test's random numbers: a hash of the test's name, so that no other test, no filter and
// no order of the tests changes what it draws.

#pragma once

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace velamap {

inline std::uint32_t TestSeed() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const char c : std::string(test->test_suite_name()) + "." + test->name()) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  }
  return hash;
}

}  // namespace velamap
