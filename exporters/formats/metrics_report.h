// Named figures: the one source of every form in which velamap shows metrics, so that the text on
// stdout, the CSV and the JSON have the same keys and cannot disagree. Units stand in the keys.
//
// A statistic S has the keys S_count and, if that is not 0, S_mean, S_std, S_median, S_min, S_max,
// S_rms. A figure that is not known has no key.

#pragma once

#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

#include "importer/base/statistics.h"

namespace velamap {

using MetricValue = std::variant<int, double, std::string, std::vector<int>, Statistics>;

struct Metric {
  std::string key;
  MetricValue value;
};
using Metrics = std::vector<Metric>;

// What there is once an image, a part, a marker, ...
struct MetricTable {
  std::string name;
  bool in_text = true;  // whether the text has it too; long tables are for the files
  std::vector<Metrics> rows;
};

struct MetricsReport {
  Metrics metrics;
  std::vector<MetricTable> tables;
};

// `key: value` lines with six digits; a row of a table is one line with the table's name as key,
// its statistics shortened to `S mean 1 std 2 median 3 min 4 max 5`.
void PrintMetrics(const MetricsReport& report, std::ostream& out);

// Header table,row,key,value, one line a figure; table and row are empty for what is no table's,
// rows count from 0. Shortest digits that read back to the same double.
void WriteMetricsCsv(const MetricsReport& report, std::ostream& out);

// One object of the figures in order, the tables as arrays of objects. Digits as in the CSV; a
// number that is not finite, which JSON does not know, is null.
void WriteMetricsJson(const MetricsReport& report, std::ostream& out);

}  // namespace velamap
