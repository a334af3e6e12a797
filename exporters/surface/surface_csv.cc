#include "exporters/surface/surface_csv.h"

#include <cmath>
#include <fstream>
#include <map>
#include <ostream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/base/statistics.h"
#include "importer/text/csv.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

const std::vector<std::string> kEdgeColumns = {"edge", "x", "y", "z"};
const std::vector<std::string> kResidualColumns = {"marker_id", "line",        "u",      "v",
                                                   "distance",  "beyond_edge", "is_used"};
constexpr double kMaxLength_m = 1e9;
constexpr std::size_t kDistance = 4, kIsUsed = 6;  // of the columns of residuals

Eigen::Vector3d ReadPoint(const CsvRecord& record, const std::string& name) {
  Eigen::Vector3d x_m;
  for (std::size_t i = 1; i < kEdgeColumns.size(); ++i) {
    double value = 0.0;
    if (!ParseNumber(record.fields[i], &value) || !(std::abs(value) <= kMaxLength_m)) {
      throw InputError(fmt::format("{}:{}: column {}: expected a number in metres, found '{}'",
                                   name, record.line, kEdgeColumns[i], record.fields[i]));
    }
    x_m[static_cast<Eigen::Index>(i) - 1] = value;
  }
  return x_m;
}

}  // namespace

void WriteSurfaceResidualsCsv(const FittedSurface& surface, std::ostream& out) {
  CsvWriter csv(out);
  csv.AddFields(kResidualColumns);
  csv.EndRecord();
  for (const SurfaceResidual& residual : surface.residuals) {
    csv.WriteRecord(residual.marker_id, residual.line, residual.u, residual.v, residual.distance_m,
                    residual.beyond_edge_m, residual.is_used);
  }
}

double ReadSurfaceResidualRms(std::istream& in, const std::string& name) {
  const std::vector<CsvRecord> records = ReadCsv(in, name);
  if (records.empty() || records.front().fields != kResidualColumns) {
    throw InputError(
        fmt::format("{}: expected the header {}", name, fmt::join(kResidualColumns, ",")));
  }
  std::vector<double> distances_m;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const CsvRecord& record = records[i];
    if (record.fields.size() != kResidualColumns.size()) {
      throw InputError(fmt::format("{}:{}: {} columns, expected {}", name, record.line,
                                   record.fields.size(), fmt::join(kResidualColumns, ",")));
    }
    double distance_m = 0.0;
    if (!ParseNumber(record.fields[kDistance], &distance_m) ||
        !(std::abs(distance_m) <= kMaxLength_m)) {
      throw InputError(fmt::format("{}:{}: column {}: expected a number in metres, found '{}'",
                                   name, record.line, kResidualColumns[kDistance],
                                   record.fields[kDistance]));
    }
    if (record.fields[kIsUsed] == "1") distances_m.push_back(distance_m);
  }
  return Rms(distances_m);
}

double ReadSurfaceResidualRms(const std::string& path) {
  CheckInputFile(path, "CSV of residuals", kMaxTextFileSize);
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw InputError(path + ": cannot be opened; expected the surface_residuals.csv of a surface");
  }
  return ReadSurfaceResidualRms(in, path);
}

void WriteSurfaceEdgesCsv(const FittedSurface& surface, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("edge", "x", "y", "z", "sigma");
  for (const SurfaceEdgePoint& point : surface.edges) {
    const Eigen::Vector3d& x = point.x_in_shape_m;
    csv.WriteRecord(point.edge, x.x(), x.y(), x.z(), point.sigma_m);
  }
}

SurfaceEdges ReadSurfaceEdges(std::istream& in, const std::string& name) {
  SurfaceEdges edges;
  const std::map<std::string, std::vector<Eigen::Vector3d>*> edge_of = {
      {"luff", &edges.luff}, {"leech", &edges.leech}, {"foot", &edges.foot}, {"head", &edges.head}};
  const std::vector<CsvRecord> records = ReadCsv(in, name);
  if (records.empty() || records.front().fields != kEdgeColumns) {
    throw InputError(fmt::format("{}: expected the header edge,x,y,z", name));
  }
  for (std::size_t i = 1; i < records.size(); ++i) {
    const CsvRecord& record = records[i];
    if (record.fields.size() != kEdgeColumns.size()) {
      throw InputError(fmt::format("{}:{}: {} columns, expected edge,x,y,z", name, record.line,
                                   record.fields.size()));
    }
    const auto edge = edge_of.find(record.fields[0]);
    if (edge == edge_of.end()) {
      throw InputError(
          fmt::format("{}:{}: column edge: expected luff, leech, foot or head, found '{}'", name,
                      record.line, record.fields[0]));
    }
    edge->second->push_back(ReadPoint(record, name));
  }
  for (const auto& [edge, points] : edge_of) {
    if (points->size() == 1) {
      throw InputError(
          fmt::format("{}: the {} edge has one point; it needs two or more", name, edge));
    }
  }
  return edges;
}

SurfaceEdges ReadSurfaceEdges(const std::string& path) {
  CheckInputFile(path, "CSV of edges", kMaxTextFileSize);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path + ": cannot be opened; expected a CSV with edge,x,y,z");
  return ReadSurfaceEdges(in, path);
}

}  // namespace velamap
