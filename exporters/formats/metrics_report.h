// Named figures. The text on stdout, the CSV and the JSON are all written from one report, so that
// they have the same keys and values. Keys end in the unit.
//
// A statistic S has the keys S_count and, if that is not 0, S_mean, S_std, S_median, S_min, S_max,
// S_rms. An unknown figure has no key.

#pragma once

#include <iosfwd>
#include <optional>
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

// Figures of each image, part, marker, ...
struct MetricTable {
  std::string name;
  bool in_text = true;  // false for long tables, which only the files have
  std::vector<Metrics> rows;
};

// The statistics of all values times a positive factor, such as a change of unit.
Statistics Scaled(double factor, Statistics statistics);

// Adds the texts with semicolons between them; nothing without any.
void AddTexts(const std::string& key, const std::vector<std::string>& texts, Metrics* metrics);

// Adds NAME_UNIT and, if it is known, NAME_sigma_UNIT, both times `factor`.
void AddEstimate(const std::string& name, const std::string& unit,
                 const std::optional<Estimate>& estimate, double factor, Metrics* metrics);

struct MetricsReport {
  Metrics metrics;
  std::vector<MetricTable> tables;
};

// Prints `key: value` lines with six digits. A row of a table is one line with the name of the
// table as its key and statistics as `S mean 1 std 2 median 3 min 4 max 5`.
void PrintMetrics(const MetricsReport& report, std::ostream& out);

// Header table,row,key,value, one line per figure with the fewest digits that read back to the same
// double. Rows count from 0; table and row are empty for figures outside tables.
void WriteMetricsCsv(const MetricsReport& report, std::ostream& out);

// One object with the figures in order and the tables as arrays of objects. Digits as in the CSV;
// a number that is not finite is null.
void WriteMetricsJson(const MetricsReport& report, std::ostream& out);

}  // namespace velamap
