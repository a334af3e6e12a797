#include "exporters/report/verdict.h"

#include <algorithm>
#include <ostream>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/text/shown_text.h"

namespace velamap {

Verdict VerdictReasons::Take() {
  Verdict verdict;
  verdict.reasons = std::move(reasons_);
  std::stable_sort(
      verdict.reasons.begin(), verdict.reasons.end(),
      [](const VerdictReason& a, const VerdictReason& b) { return a.level > b.level; });
  if (!verdict.reasons.empty()) verdict.level = verdict.reasons.front().level;
  return verdict;
}

Verdict MakeVerdict(const std::vector<KeyNumber>& numbers,
                    const std::vector<std::string>& warnings) {
  std::vector<KeyNumber> doubtful;
  for (const KeyNumber& number : numbers) {
    if (number.status > ReportStatus::kGood) doubtful.push_back(number);
  }
  std::stable_sort(doubtful.begin(), doubtful.end(),
                   [](const KeyNumber& a, const KeyNumber& b) { return a.kind < b.kind; });
  VerdictReasons reasons;
  std::set<std::string> said;  // the log repeats a warning for each step that meets it
  for (const KeyNumber& number : doubtful) {
    said.insert(number.advice);
    reasons.Add(number.status, fmt::format("{}: {}{}{}", KeyNumberName(number.kind), number.value,
                                           number.advice.empty() ? "" : "; ", number.advice));
  }
  for (const std::string& warning : warnings) {
    if (said.insert(warning).second) reasons.Check(warning);
  }
  return reasons.Take();
}

Verdict MakeVerdict(const ReportInput& input) {
  return MakeVerdict(MakeKeyNumbers(input), input.warnings);
}

void PrintVerdict(const Verdict& verdict, std::ostream& out) {
  out << "verdict: " << StatusName(verdict.level) << '\n';
  for (const VerdictReason& reason : verdict.reasons) {
    out << "verdict_reason: " << StatusName(reason.level) << "; " << reason.text << '\n';
  }
}

nlohmann::ordered_json VerdictJson(const Verdict& verdict) {
  auto reasons = nlohmann::ordered_json::array();
  for (const VerdictReason& reason : verdict.reasons) {
    reasons.push_back({{"level", StatusName(reason.level)}, {"text", StripFolders(reason.text)}});
  }
  return {{"level", StatusName(verdict.level)}, {"reasons", std::move(reasons)}};
}

}  // namespace velamap
