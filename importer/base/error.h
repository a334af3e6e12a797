// The kinds of failure, one for each exit code of the program.
//
//   InputError         exit 2   a bad file or option; the message names it and the remedy
//   DataError          exit 1   good input that does not support a result; the message says why
//   ExternalToolError  exit 3   COLMAP is absent, has failed, or its result is implausible
//   std::logic_error   exit 4   a broken invariant of velamap (VELAMAP_CHECK)
//
// They are thrown where the fault is found and caught in one place, workflows/commands/program.cc.

#pragma once

#include <stdexcept>
#include <string>

namespace velamap {

class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ExternalToolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void ThrowCheckFailure(const char* expression, const char* file, int line) {
  throw std::logic_error(std::string("broken invariant: ") + expression + " (" + file + ":" +
                         std::to_string(line) + ")");
}

}  // namespace velamap

#define VELAMAP_CHECK(expression) \
  ((expression) ? void(0) : ::velamap::ThrowCheckFailure(#expression, __FILE_NAME__, __LINE__))
