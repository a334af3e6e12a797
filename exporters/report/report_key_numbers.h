// The key numbers at the top of the report, each with an explanation and a verdict.

#pragma once

#include <string>
#include <vector>

#include "exporters/report/report_data.h"

namespace velamap {

enum class ReportStatus {
  kNone,  // no verdict
  kGood,
  kCheck,  // check the charts
  kBad,    // find the cause before using the shape
};

// In order of importance: of two equally bad key numbers, a verdict names the earlier one first.
// Measurements from outside the images come before causes, and these before effects.
enum class KeyNumberKind {
  kDictionary,
  kMeasuredDistances,
  kKnownPoints,
  kCalibration,
  kSteadiness,
  kCamera,
  kRollingShutter,
  kScale,
  kReprojectionError,
  kMarkerAreaError,
  kMarkers,
  kImages,
  kPrecision,
  kSize,
};

// The title of its card.
std::string KeyNumberName(KeyNumberKind kind);

struct KeyNumber {
  KeyNumberKind kind;
  std::string value;    // with its unit
  std::string meaning;  // one line, with the limits of the verdict
  ReportStatus status = ReportStatus::kNone;
  std::string advice = {};  // what to do where the status is not good, one sentence
};

// In the order of the cards.
std::vector<KeyNumber> MakeKeyNumbers(const ReportInput& input);

// "good", "check", "bad", or empty for kNone.
std::string StatusName(ReportStatus status);

}  // namespace velamap
