// Sets, for its lifetime, the date that is written into files.

#pragma once

#include <cstdlib>
#include <string>

namespace velamap {

class ScopedDate {
 public:
  explicit ScopedDate(const std::string& seconds_since_1970) {
    setenv("SOURCE_DATE_EPOCH", seconds_since_1970.c_str(), 1);
  }
  ScopedDate(const ScopedDate&) = delete;
  ScopedDate& operator=(const ScopedDate&) = delete;
  ~ScopedDate() { unsetenv("SOURCE_DATE_EPOCH"); }
};

}  // namespace velamap
