#include "exporters/formats/shape_csv.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <istream>
#include <limits>
#include <map>
#include <ostream>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/text/csv.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

enum Column { kMarkerId, kCorner, kX, kSigmaX = kX + 3, kNumFrames = kSigmaX + 3, kPart };

constexpr std::array<const char*, kPart + 1> kColumns = {
    "marker_id", "corner", "x", "y", "z", "sigma_x", "sigma_y", "sigma_z", "num_frames", "part"};

// Lets a file pass whose coordinates are rounded to a millimetre.
constexpr double kCenterTolerance_m = 1e-3;

std::string Header() { return fmt::format("{}", fmt::join(kColumns, ",")); }

struct Row {
  int marker_id = 0;
  int corner = 0;
  Eigen::Vector3d x_in_shape_m;
  std::optional<Eigen::Vector3d> sigma_m;
  int num_frames = 0;
  std::string part;
};

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Reads the fields of one record. Errors name the file, the line and the column.
class RecordReader {
 public:
  RecordReader(const CsvRecord& record, const std::string& name) : record_(record), name_(name) {
    if (record.fields.size() == kColumns.size()) return;
    throw InputError(fmt::format("{}:{}: {} columns, expected the {} of {}", name, record.line,
                                 record.fields.size(), kColumns.size(), Header()));
  }

  [[noreturn]] void Fail(int column, const std::string& problem) const {
    throw InputError(
        fmt::format("{}:{}: column {}: {}", name_, record_.line, kColumns.at(column), problem));
  }

  int ReadInt(int column, int min, int max) const {
    const std::optional<int> value = Parse<int>(column);
    if (!value || *value < min || *value > max) {
      Fail(column, fmt::format("expected an integer from {} to {}, found '{}'", min, max,
                               record_.fields[column]));
    }
    return *value;
  }

  double ReadDouble(int column, double min) const {
    const std::optional<double> value = Parse<double>(column);
    constexpr double kMaxCoordinate_m = 1e9;
    if (!value || !(std::abs(*value) <= kMaxCoordinate_m) || *value < min) {
      Fail(column, fmt::format("expected {} in metres with a decimal point, found '{}'",
                               min == 0 ? "a number from 0" : "a number", record_.fields[column]));
    }
    return *value;
  }

  Eigen::Vector3d ReadVector(int first_column, double min) const {
    return {ReadDouble(first_column, min), ReadDouble(first_column + 1, min),
            ReadDouble(first_column + 2, min)};
  }

  bool IsEmpty(int column) const { return Trim(record_.fields[column]).empty(); }

 private:
  // Nothing unless the whole field is one number.
  template <typename T>
  std::optional<T> Parse(int column) const {
    T value{};
    if (!ParseNumber(Trim(record_.fields[column]), &value)) return std::nullopt;
    return value;
  }

  const CsvRecord& record_;
  const std::string& name_;
};

Row ReadRow(const CsvRecord& record, const RecordReader& reader) {
  Row row;
  row.marker_id = reader.ReadInt(kMarkerId, 0, kMaxMarkerId);
  row.corner = reader.ReadInt(kCorner, 0, kNumCorners);
  row.x_in_shape_m = reader.ReadVector(kX, std::numeric_limits<double>::lowest());
  if (!(reader.IsEmpty(kSigmaX) && reader.IsEmpty(kSigmaX + 1) && reader.IsEmpty(kSigmaX + 2))) {
    row.sigma_m = reader.ReadVector(kSigmaX, 0.0);
  }
  row.num_frames = reader.ReadInt(kNumFrames, 0, std::numeric_limits<int>::max());
  row.part = record.fields[kPart];
  return row;
}

void AddRow(const Row& row, const RecordReader& reader, bool is_new, ShapeMarker* marker) {
  if (is_new) {
    marker->marker_id = row.marker_id;
    marker->part = row.part;
  }
  if (marker->part != row.part) {
    reader.Fail(kPart, fmt::format("marker {} is on '{}' here and on '{}' in an earlier row",
                                   row.marker_id, row.part, marker->part));
  }
  if (marker->x_in_shape_m[row.corner]) {
    reader.Fail(kCorner, fmt::format("corner {} of marker {} has a row already; remove one of them",
                                     row.corner, row.marker_id));
  }
  marker->x_in_shape_m[row.corner] = row.x_in_shape_m;
  marker->sigma_m[row.corner] = row.sigma_m;
  marker->num_frames[row.corner] = row.num_frames;
}

// Fills in the centre if all corners are known, as marker_shape.h requires. Returns what is wrong
// with a centre of the file, or an empty text.
std::string CompleteCenter(ShapeMarker* marker) {
  const std::optional<Eigen::Vector3d>& center = marker->x_in_shape_m[0];
  if (!center) {
    SetCenter(marker);
    return "";
  }
  const std::optional<Eigen::Vector3d> mean = MeanOfCorners(*marker);
  if (!mean) return "a centre without its four corners; add them or remove this row";
  const double distance_m = (*center - *mean).norm();
  if (distance_m <= kCenterTolerance_m) return "";
  return fmt::format("the centre is {:.3g} m from the mean of its corners; remove this row",
                     distance_m);
}

}  // namespace

void WriteShapeCsv(const MarkerShape& shape, std::ostream& out) {
  CsvWriter csv(out);
  csv.AddFields(kColumns);
  csv.EndRecord();
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 0; corner <= kNumCorners; ++corner) {
      if (!marker.x_in_shape_m[corner]) continue;
      csv.AddField(marker.marker_id);
      csv.AddField(corner);
      csv.AddFields(*marker.x_in_shape_m[corner]);
      for (int axis = 0; axis < 3; ++axis) {
        const auto& sigma_m = marker.sigma_m[corner];
        csv.AddField(sigma_m ? std::optional((*sigma_m)[axis]) : std::nullopt);
      }
      csv.AddField(marker.num_frames[corner]);
      csv.AddField(marker.part);
      csv.EndRecord();
    }
  }
}

MarkerShape ReadShapeCsv(std::istream& in, const std::string& name) {
  const std::vector<CsvRecord> records = ReadCsv(in, name);
  if (records.empty() ||
      !std::equal(records[0].fields.begin(), records[0].fields.end(), kColumns.begin(),
                  kColumns.end(), [](const auto& a, const auto& b) { return Trim(a) == b; })) {
    throw InputError(fmt::format("{}:{}: expected the header {} (comma-separated)", name,
                                 records.empty() ? 1 : records[0].line, Header()));
  }
  if (records.size() == 1) throw InputError(name + ": no marker follows the header");

  std::map<int, ShapeMarker> markers;
  std::map<int, int> centre_lines;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const RecordReader reader(records[i], name);
    const Row row = ReadRow(records[i], reader);
    const auto [marker, is_new] = markers.try_emplace(row.marker_id);
    AddRow(row, reader, is_new, &marker->second);
    if (row.corner == 0) centre_lines[row.marker_id] = records[i].line;
  }

  MarkerShape shape;
  for (auto& [marker_id, marker] : markers) {
    const std::string problem = CompleteCenter(&marker);
    if (!problem.empty()) {
      throw InputError(fmt::format("{}:{}: column {}: marker {}: {}", name,
                                   centre_lines.at(marker_id), kColumns[kCorner], marker_id,
                                   problem));
    }
    shape.markers.push_back(std::move(marker));
  }
  return shape;
}

MarkerShape ReadShapeCsv(const std::string& path) {
  constexpr std::uintmax_t kMaxSize = 256 << 20;
  CheckInputFile(path, "shape.csv", kMaxSize);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path + ": cannot be opened; expected a shape.csv");
  return ReadShapeCsv(in, path);
}

}  // namespace velamap
