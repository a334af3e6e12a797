#include "tests/support/option_range.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

void CheckOptionRange(const char* option, double value, double min, double max) {
  if (value >= min && value <= max) return;
  throw InputError(fmt::format("--{}: {} is out of range; give {} to {}", option, value, min, max));
}

}  // namespace velamap
