// The date that files say they were written on.

#pragma once

#include <ctime>
#include <string>

namespace velamap {

// The current time, UTC, unless the environment variable SOURCE_DATE_EPOCH sets another one, in
// seconds since 1970 (https://reproducible-builds.org/specs/source-date-epoch). Throws InputError
// if that is not a valid time.
std::tm OutputDate();

// "2024-05-01 14:02 UTC".
std::string DateText(const std::tm& utc);

}  // namespace velamap
