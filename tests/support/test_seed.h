// A seed for the random numbers of a test. It is a hash of the test's name, so the numbers do not
// depend on other tests, filters or the order of the tests.

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
