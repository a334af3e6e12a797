#include "importer/database/image_formation_table.h"

#include <SQLiteCpp/SQLiteCpp.h>

namespace velamap {
namespace {

constexpr char kSchema[] = R"(
CREATE TABLE IF NOT EXISTS image_formation (
    gamma REAL NOT NULL,
    s_amplitude REAL NOT NULL,
    sharpening REAL NOT NULL,
    sharpening_radius_px REAL NOT NULL,
    ink_spread_sides REAL NOT NULL,
    is_inverted INTEGER NOT NULL,
    quiet_zone_cells REAL NOT NULL,
    quiet_zone_sigma_cells REAL NOT NULL,
    num_samples INTEGER NOT NULL,
    noise_gray REAL NOT NULL,
    inset_sigma_px REAL NOT NULL);
)";

}  // namespace

void WriteImageFormation(const FormationEstimate& estimate, SQLite::Database* database) {
  database->exec(kSchema);
  database->exec("DELETE FROM image_formation");
  SQLite::Statement insert(
      *database,
      "INSERT INTO image_formation(gamma, s_amplitude, sharpening, sharpening_radius_px,"
      " ink_spread_sides, is_inverted, quiet_zone_cells, quiet_zone_sigma_cells, num_samples,"
      " noise_gray, inset_sigma_px) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const ImageFormationParameters& found = estimate.parameters;
  insert.bind(1, found.gamma);
  insert.bind(2, found.s_amplitude);
  insert.bind(3, found.sharpening);
  insert.bind(4, found.sharpening_radius_px);
  insert.bind(5, found.ink_spread_sides);
  insert.bind(6, found.is_inverted ? 1 : 0);
  insert.bind(7, found.quiet_zone_cells);
  insert.bind(8, found.quiet_zone_sigma_cells);
  insert.bind(9, estimate.num_samples);
  insert.bind(10, estimate.noise_gray);
  insert.bind(11, estimate.inset_sigma_px);
  insert.exec();
}

std::optional<FormationEstimate> ReadImageFormation(SQLite::Database* database) {
  if (!database->tableExists("image_formation")) return std::nullopt;
  SQLite::Statement query(
      *database,
      "SELECT gamma, s_amplitude, sharpening, sharpening_radius_px, ink_spread_sides, is_inverted,"
      " quiet_zone_cells, quiet_zone_sigma_cells, num_samples, noise_gray, inset_sigma_px FROM "
      "image_formation");
  if (!query.executeStep()) return std::nullopt;
  FormationEstimate estimate;
  ImageFormationParameters& found = estimate.parameters;
  found.gamma = query.getColumn(0).getDouble();
  found.s_amplitude = query.getColumn(1).getDouble();
  found.sharpening = query.getColumn(2).getDouble();
  found.sharpening_radius_px = query.getColumn(3).getDouble();
  found.ink_spread_sides = query.getColumn(4).getDouble();
  found.is_inverted = query.getColumn(5).getInt() != 0;
  found.quiet_zone_cells = query.getColumn(6).getDouble();
  found.quiet_zone_sigma_cells = query.getColumn(7).getDouble();
  estimate.num_samples = query.getColumn(8).getInt();
  estimate.noise_gray = query.getColumn(9).getDouble();
  estimate.inset_sigma_px = query.getColumn(10).getDouble();
  return estimate;
}

}  // namespace velamap
