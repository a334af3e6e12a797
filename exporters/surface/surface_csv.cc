#include "exporters/surface/surface_csv.h"

#include <cmath>
#include <fstream>
#include <map>
#include <ostream>
#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/text/csv.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

const std::vector<std::string> kEdgeColumns = {"edge", "x", "y", "z"};

Eigen::Vector3d ReadPoint(const CsvRecord& record, const std::string& name) {
  Eigen::Vector3d x_m;
  for (std::size_t i = 1; i < kEdgeColumns.size(); ++i) {
    double value = 0.0;
    constexpr double kMaxCoordinate_m = 1e9;
    if (!ParseNumber(record.fields[i], &value) || !(std::abs(value) <= kMaxCoordinate_m)) {
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
  csv.WriteRecord("marker_id", "line", "u", "v", "distance", "beyond_edge", "is_used");
  for (const SurfaceResidual& residual : surface.residuals) {
    csv.WriteRecord(residual.marker_id, residual.line, residual.u, residual.v, residual.distance_m,
                    residual.beyond_edge_m, residual.is_used);
  }
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
