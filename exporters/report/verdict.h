// One verdict on a result, for the report and the summary.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/report/report_key_numbers.h"

namespace velamap {

struct VerdictReason {
  ReportStatus level = ReportStatus::kCheck;  // kCheck or kBad
  std::string text;                           // one sentence with the remedy
};

struct Verdict {
  ReportStatus level = ReportStatus::kGood;  // kGood, kCheck or kBad: that of the first reason
  std::vector<VerdictReason> reasons;        // the heaviest first; empty for kGood
};

// Every key number that is not good is a reason, and every warning is a reason to check. Bad ones
// come first; of the same level, key numbers in the order of KeyNumberKind, then warnings.
Verdict MakeVerdict(const std::vector<KeyNumber>& numbers,
                    const std::vector<std::string>& warnings);
Verdict MakeVerdict(const ReportInput& input);

// `verdict: good|check|bad` and a line `verdict_reason: ...` for each reason.
void PrintVerdict(const Verdict& verdict, std::ostream& out);

}  // namespace velamap
