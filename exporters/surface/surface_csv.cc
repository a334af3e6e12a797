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

// The records below the header. It and the number of fields in each record have to fit `columns`.
std::vector<CsvRecord> ReadTable(std::istream& in, const std::vector<std::string>& columns,
                                 const std::string& name) {
  const std::string header = fmt::format("{}", fmt::join(columns, ","));
  std::vector<CsvRecord> records = ReadCsv(in, name);
  if (records.empty() || records.front().fields != columns) {
    throw InputError(fmt::format("{}: expected the header {}", name, header));
  }
  records.erase(records.begin());
  for (const CsvRecord& record : records) {
    if (record.fields.size() == columns.size()) continue;
    throw InputError(fmt::format("{}:{}: {} columns, expected {}", name, record.line,
                                 record.fields.size(), header));
  }
  return records;
}

double ReadLength(const CsvRecord& record, std::size_t column,
                  const std::vector<std::string>& columns, const std::string& name) {
  double length_m = 0.0;
  if (!ParseNumber(record.fields[column], &length_m) || !(std::abs(length_m) <= kMaxLength_m)) {
    throw InputError(fmt::format("{}:{}: column {}: expected a number in metres, found '{}'", name,
                                 record.line, columns[column], record.fields[column]));
  }
  return length_m;
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
  std::vector<double> distances_m;
  for (const CsvRecord& record : ReadTable(in, kResidualColumns, name)) {
    const double distance_m = ReadLength(record, kDistance, kResidualColumns, name);
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
  const std::map<std::string, SurfaceEdge*> edge_of = {
      {"luff", &edges.luff}, {"leech", &edges.leech}, {"foot", &edges.foot}, {"head", &edges.head}};
  for (const CsvRecord& record : ReadTable(in, kEdgeColumns, name)) {
    const auto edge = edge_of.find(record.fields[0]);
    if (edge == edge_of.end()) {
      throw InputError(
          fmt::format("{}:{}: column edge: expected luff, leech, foot or head, found '{}'", name,
                      record.line, record.fields[0]));
    }
    const auto coordinate = [&](std::size_t column) {
      return ReadLength(record, column, kEdgeColumns, name);
    };
    edge->second->points_m.push_back({coordinate(1), coordinate(2), coordinate(3)});
  }
  for (const auto& [name_of_edge, edge] : edge_of) {
    if (edge->points_m.size() == 1) {
      throw InputError(
          fmt::format("{}: the {} edge has one point; it needs two or more", name, name_of_edge));
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
