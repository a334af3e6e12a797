#include "importer/database/image_formation_table.h"

#include <set>
#include <string>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include "importer/database/checked_number.h"
#include "importer/database/colmap_schema.h"

namespace velamap {
namespace {

constexpr char kFormationSchema[] = R"(
CREATE TABLE image_formation (
    gamma REAL NOT NULL,
    s_amplitude REAL NOT NULL,
    sharpening REAL NOT NULL,
    sharpening_radius_px REAL NOT NULL,
    ink_spread_mm REAL NOT NULL,
    edge_shift_blurs REAL NOT NULL,
    outline_shift_blurs REAL NOT NULL,
    outline_corner_weight REAL NOT NULL,
    is_inverted INTEGER NOT NULL,
    quiet_zone_cells REAL NOT NULL,
    quiet_zone_sigma_cells REAL NOT NULL,
    halo REAL NOT NULL,
    halo_radius_px REAL NOT NULL,
    num_samples INTEGER NOT NULL,
    noise_gray REAL NOT NULL,
    inset_sigma_px REAL NOT NULL);
)";

}  // namespace

void WriteImageFormation(const FormationEstimate& estimate, SQLite::Database* database) {
  // The table of an earlier velamap has fewer columns.
  database->exec("DROP TABLE IF EXISTS image_formation");
  database->exec(kFormationSchema);
  SQLite::Statement insert(
      *database,
      "INSERT INTO image_formation VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const ImageFormationParameters& found = estimate.parameters;
  SQLite::bind(insert, found.gamma, found.s_amplitude, found.sharpening, found.sharpening_radius_px,
               found.ink_spread_mm, found.edge_shift_blurs, found.outline_shift_blurs,
               found.outline_corner_weight, found.is_inverted ? 1 : 0, found.quiet_zone_cells,
               found.quiet_zone_sigma_cells, found.halo, found.halo_radius_px, estimate.num_samples,
               estimate.noise_gray, estimate.inset_sigma_px);
  insert.exec();
}

std::optional<FormationEstimate> ReadImageFormation(const std::string& path,
                                                    SQLite::Database* database) {
  // Columns that earlier versions lacked, with the values that these versions assumed. They gave
  // the ink's spread as a share of the side, which is converted for sides of 100 mm.
  const std::set<std::string> columns = ColumnNames(*database, "image_formation");
  if (columns.empty()) return std::nullopt;
  const std::string ink_mm =
      fmt::format("MAX({}, MIN({}, 100 * ink_spread_sides))", -kMaxInkSpread_mm, kMaxInkSpread_mm);
  std::string missing;
  for (const auto& [column, value] : {std::pair("outline_corner_weight", "1"),
                                      {"ink_spread_mm", ink_mm.c_str()},
                                      {"edge_shift_blurs", "0"},
                                      {"outline_shift_blurs", "0"},
                                      {"halo", "0"},
                                      {"halo_radius_px", "1"}}) {
    if (columns.count(column) == 0) missing += fmt::format(", {} AS {}", value, column);
  }
  SQLite::Statement query(*database, fmt::format("SELECT *{} FROM image_formation", missing));
  if (!query.executeStep()) return std::nullopt;
  const auto number = [&](const char* column, const OptionRange& range) {
    return CheckedNumber({path, "image_formation"}, column, range, &query);
  };
  FormationEstimate estimate;
  ImageFormationParameters& found = estimate.parameters;
  found.gamma = number("gamma", FromTo(0.5, 5));
  found.s_amplitude = number("s_amplitude", FromTo(-0.15, 0.15));  // the curve rises everywhere
  found.sharpening = number("sharpening", FromTo(-0.9, 10));
  found.sharpening_radius_px = number("sharpening_radius_px", FromTo(0.1, 10));
  found.ink_spread_mm = number("ink_spread_mm", FromTo(-kMaxInkSpread_mm, kMaxInkSpread_mm));
  found.edge_shift_blurs = number("edge_shift_blurs", FromTo(-2, 2));
  found.outline_shift_blurs = number("outline_shift_blurs", FromTo(-2, 2));
  found.outline_corner_weight = number("outline_corner_weight", FromTo(0, 1));
  found.is_inverted = number("is_inverted", FromTo(0, 1)) != 0;
  found.quiet_zone_cells = number("quiet_zone_cells", FromTo(0, 100));
  found.quiet_zone_sigma_cells = number("quiet_zone_sigma_cells", FromTo(0, 100));
  found.halo = number("halo", FromTo(-0.5, 0.5));
  found.halo_radius_px = number("halo_radius_px", FromTo(0.1, 10));
  estimate.num_samples = static_cast<int>(number("num_samples", FromTo(0, 1e6)));
  estimate.noise_gray = number("noise_gray", FromTo(0, 255));
  estimate.inset_sigma_px = number("inset_sigma_px", FromTo(0, 100));
  return estimate;
}

}  // namespace velamap
