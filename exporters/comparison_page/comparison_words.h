// A comparison in plain words.

#pragma once

#include <string>
#include <vector>

#include "exporters/comparison_page/comparison_page.h"

namespace velamap {

// "trim2 against trim1", "3 shapes against trim1".
std::string ComparisonTitle(const ComparisonPageInput& input);

// A section number without its unit, and the unit: "draft position", "%".
std::string NumberName(const std::string& number);
std::string NumberUnit(const std::string& number);

// The name of a section, preceded by the name of its part if the series has sections of several
// parts.
std::string SectionName(const std::vector<Comparison>& series, const std::string& part,
                        const std::string& section);

struct ComparisonVerdict {
  std::string text;                // one sentence
  std::vector<std::string> items;  // the figures behind it, and cautions
  std::string level;               // "bad", "check" or empty: the worst ShapeDeviation::doubt
};

ComparisonVerdict JudgeComparison(const ComparisonPageInput& input);

}  // namespace velamap
