// One verdict on a result, for the report and the summary.

#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "exporters/report/report_data.h"
#include "exporters/report/report_key_numbers.h"

namespace velamap {

struct VerdictReason {
  ReportStatus level = ReportStatus::kCheck;  // kCheck or kBad
  std::string text;                           // one sentence with the remedy
};

struct Verdict {
  ReportStatus level = ReportStatus::kGood;  // kGood, kCheck or kBad: the level of the first reason
  std::vector<VerdictReason> reasons;        // the worst first; empty for kGood
};

// Collects reasons in the order in which they are found.
class VerdictReasons {
 public:
  void Add(ReportStatus level, std::string text) { reasons_.push_back({level, std::move(text)}); }
  void Bad(std::string text) { Add(ReportStatus::kBad, std::move(text)); }
  void Check(std::string text) { Add(ReportStatus::kCheck, std::move(text)); }

  // The worst first; those of one level in the order in which they were added.
  Verdict Take();

 private:
  std::vector<VerdictReason> reasons_;
};

// Every key number that is not good is a reason, and every warning is a reason to check. Bad ones
// come first; within a level, key numbers come in the order of KeyNumberKind, then warnings.
Verdict MakeVerdict(const std::vector<KeyNumber>& numbers,
                    const std::vector<std::string>& warnings);
Verdict MakeVerdict(const ReportInput& input);

// `verdict: good|check|bad` and a line `verdict_reason: ...` for each reason.
void PrintVerdict(const Verdict& verdict, std::ostream& out);

// Level and reasons for the files that are passed on to others: without the folders in the reasons.
nlohmann::ordered_json VerdictJson(const Verdict& verdict);

}  // namespace velamap
