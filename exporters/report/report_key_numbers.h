// The figures at the head of the report: what each means in one line, and whether it is good.

#pragma once

#include <string>
#include <vector>

#include "exporters/report/report_data.h"

namespace velamap {

enum class ReportStatus {
  kNone,  // a figure that is neither good nor bad
  kGood,
  kCheck,  // worth a look at the charts below
  kBad,    // do not use the shape before the cause is found
};

struct KeyNumber {
  std::string name;
  std::string value;    // with its unit
  std::string meaning;  // one line, with the limits of the verdict
  ReportStatus status = ReportStatus::kNone;
};

std::vector<KeyNumber> MakeKeyNumbers(const ReportInput& input);

// good, check, bad; empty for kNone.
std::string StatusName(ReportStatus status);

}  // namespace velamap
