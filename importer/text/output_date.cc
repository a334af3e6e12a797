#include "importer/text/output_date.h"

#include <cstdlib>

#include <fmt/chrono.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {

std::tm OutputDate() {
  constexpr std::time_t kEndOfYear9999 = 253402300799;
  std::time_t time = std::time(nullptr);
  const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
  if (epoch && (!ParseNumber(epoch, &time) || time < 0 || time > kEndOfYear9999)) {
    throw InputError(fmt::format(
        "SOURCE_DATE_EPOCH: expected seconds since 1970, found '{}'; correct or unset it", epoch));
  }
  return fmt::gmtime(time);
}

std::string DateText(const std::tm& utc) { return fmt::format("{:%Y-%m-%d %H:%M} UTC", utc); }

}  // namespace velamap
