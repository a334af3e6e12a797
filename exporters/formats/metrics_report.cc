#include "exporters/formats/metrics_report.h"

#include <ostream>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/text/csv.h"
#include "importer/text/json_text.h"

namespace velamap {
namespace {

std::string ValueText(const MetricValue& metric_value, const char* double_format) {
  return std::visit(
      [double_format](const auto& value) -> std::string {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, double>) {
          return fmt::format(fmt::runtime(double_format), value);
        } else if constexpr (std::is_same_v<T, std::vector<int>>) {
          return fmt::format("{}", fmt::join(value, " "));
        } else if constexpr (std::is_same_v<T, Statistics>) {
          const auto number = [&](double x) { return fmt::format(fmt::runtime(double_format), x); };
          if (value.count == 0) return "none";
          return fmt::format("mean {} std {} median {} min {} max {}", number(value.mean),
                             number(value.standard_deviation), number(value.median),
                             number(value.min), number(value.max));
        } else {
          return fmt::format("{}", value);
        }
      },
      metric_value);
}

std::string Text(const MetricValue& value) {
  const std::string text = SingleLine(ValueText(value, "{:.6g}"));
  return text.empty() ? "none" : text;
}

Metrics StatisticFigures(const std::string& key, const Statistics& statistics) {
  Metrics metrics = {{key + "_count", statistics.count}};
  if (statistics.count == 0) return metrics;
  metrics.push_back({key + "_mean", statistics.mean});
  metrics.push_back({key + "_std", statistics.standard_deviation});
  metrics.push_back({key + "_median", statistics.median});
  metrics.push_back({key + "_min", statistics.min});
  metrics.push_back({key + "_max", statistics.max});
  metrics.push_back({key + "_rms", statistics.rms});
  return metrics;
}

// The metrics with every statistic replaced by its figures.
Metrics Figures(const Metrics& metrics) {
  Metrics figures;
  for (const Metric& metric : metrics) {
    if (const auto* statistics = std::get_if<Statistics>(&metric.value)) {
      for (Metric& figure : StatisticFigures(metric.key, *statistics)) {
        figures.push_back(std::move(figure));
      }
    } else {
      figures.push_back(metric);
    }
  }
  return figures;
}

void WriteCsvRows(const std::string& table, std::optional<std::size_t> row, const Metrics& metrics,
                  CsvWriter* csv) {
  for (const Metric& figure : Figures(metrics)) {
    csv->WriteRecord(table, row, figure.key, ValueText(figure.value, "{}"));
  }
}

nlohmann::ordered_json JsonObject(const Metrics& metrics) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const Metric& figure : Figures(metrics)) {
    std::visit(
        [&](const auto& value) {
          using T = std::decay_t<decltype(value)>;
          if constexpr (!std::is_same_v<T, Statistics>) object[figure.key] = value;
        },
        figure.value);
  }
  return object;
}

}  // namespace

Statistics Scaled(double factor, Statistics statistics) {
  for (double* figure : {&statistics.mean, &statistics.standard_deviation, &statistics.median,
                         &statistics.min, &statistics.max, &statistics.rms}) {
    *figure *= factor;
  }
  return statistics;
}

void AddTexts(const std::string& key, const std::vector<std::string>& texts, Metrics* metrics) {
  if (!texts.empty()) metrics->push_back({key, fmt::format("{}", fmt::join(texts, "; "))});
}

void AddEstimate(const std::string& name, const std::string& unit,
                 const std::optional<Estimate>& estimate, double factor, Metrics* metrics) {
  if (!estimate) return;
  metrics->push_back({name + '_' + unit, factor * estimate->value});
  if (estimate->sigma) metrics->push_back({name + "_sigma_" + unit, factor * *estimate->sigma});
}

void PrintMetrics(const MetricsReport& report, std::ostream& out) {
  for (const Metric& figure : Figures(report.metrics)) {
    out << figure.key << ": " << Text(figure.value) << '\n';
  }
  for (const MetricTable& table : report.tables) {
    if (!table.in_text) continue;
    for (const Metrics& row : table.rows) {
      out << table.name << ':';
      const char* separator = " ";
      for (const Metric& metric : row) {
        out << separator << metric.key << ' ' << Text(metric.value);
        separator = ", ";
      }
      out << '\n';
    }
  }
}

void WriteMetricsCsv(const MetricsReport& report, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("table", "row", "key", "value");
  WriteCsvRows("", std::nullopt, report.metrics, &csv);
  for (const MetricTable& table : report.tables) {
    for (std::size_t row_idx = 0; row_idx < table.rows.size(); ++row_idx) {
      WriteCsvRows(table.name, row_idx, table.rows[row_idx], &csv);
    }
  }
}

void WriteMetricsJson(const MetricsReport& report, std::ostream& out) {
  nlohmann::ordered_json json = JsonObject(report.metrics);
  for (const MetricTable& table : report.tables) {
    nlohmann::ordered_json& rows = json[table.name] = nlohmann::ordered_json::array();
    for (const Metrics& row : table.rows) rows.push_back(JsonObject(row));
  }
  out << JsonText(json, 1) << '\n';
}

}  // namespace velamap
