#include "importer/text/output_date.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/scoped_date.h"

namespace velamap {
namespace {

TEST(OutputDate, IsNowUnlessTheEnvironmentSaysOtherwise) {
  std::tm now = OutputDate();
  EXPECT_LT(std::abs(std::difftime(timegm(&now), std::time(nullptr))), 60);
  const ScopedDate scoped("1700000000");
  std::tm date = OutputDate();
  EXPECT_EQ(timegm(&date), 1700000000);
  EXPECT_EQ(DateText(date), "2023-11-14 22:13 UTC");
}

TEST(OutputDate, WhatIsNoTimeIsRefused) {
  for (const char* text : {"", "today", "-1", "1.5", "253402300800"}) {
    const ScopedDate scoped(text);
    ExpectThrows<InputError>([] { OutputDate(); }, {"SOURCE_DATE_EPOCH", "seconds since 1970"});
  }
}

}  // namespace
}  // namespace velamap
