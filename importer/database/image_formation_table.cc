#include "importer/database/image_formation_table.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

namespace velamap {
namespace {

constexpr char kSchema[] = R"(
CREATE TABLE IF NOT EXISTS image_formation (
    gamma REAL NOT NULL,
    s_amplitude REAL NOT NULL,
    sharpening REAL NOT NULL,
    sharpening_radius_px REAL NOT NULL,
    sharpens_light INTEGER NOT NULL,
    ink_spread_sides REAL NOT NULL,
    is_inverted INTEGER NOT NULL,
    quiet_zone_cells REAL NOT NULL,
    quiet_zone_sigma_cells REAL NOT NULL,
    num_samples INTEGER NOT NULL,
    noise_gray REAL NOT NULL,
    inset_sigma_px REAL NOT NULL);
)";

constexpr char kColumns[] =
    "gamma, s_amplitude, sharpening, sharpening_radius_px, sharpens_light, ink_spread_sides,"
    " is_inverted, quiet_zone_cells, quiet_zone_sigma_cells, num_samples, noise_gray,"
    " inset_sigma_px";

}  // namespace

void WriteImageFormation(const FormationEstimate& estimate, SQLite::Database* database) {
  database->exec(kSchema);
  database->exec("DELETE FROM image_formation");
  SQLite::Statement insert(
      *database, fmt::format("INSERT INTO image_formation({}) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
                             " ?, ?)",
                             kColumns));
  const ImageFormationParameters& found = estimate.parameters;
  SQLite::bind(insert, found.gamma, found.s_amplitude, found.sharpening, found.sharpening_radius_px,
               found.sharpens_light ? 1 : 0, found.ink_spread_sides, found.is_inverted ? 1 : 0,
               found.quiet_zone_cells, found.quiet_zone_sigma_cells, estimate.num_samples,
               estimate.noise_gray, estimate.inset_sigma_px);
  insert.exec();
}

std::optional<FormationEstimate> ReadImageFormation(SQLite::Database* database) {
  if (!database->tableExists("image_formation")) return std::nullopt;
  SQLite::Statement query(*database, fmt::format("SELECT {} FROM image_formation", kColumns));
  if (!query.executeStep()) return std::nullopt;
  FormationEstimate estimate;
  ImageFormationParameters& found = estimate.parameters;
  found.gamma = query.getColumn("gamma").getDouble();
  found.s_amplitude = query.getColumn("s_amplitude").getDouble();
  found.sharpening = query.getColumn("sharpening").getDouble();
  found.sharpening_radius_px = query.getColumn("sharpening_radius_px").getDouble();
  found.sharpens_light = query.getColumn("sharpens_light").getInt() != 0;
  found.ink_spread_sides = query.getColumn("ink_spread_sides").getDouble();
  found.is_inverted = query.getColumn("is_inverted").getInt() != 0;
  found.quiet_zone_cells = query.getColumn("quiet_zone_cells").getDouble();
  found.quiet_zone_sigma_cells = query.getColumn("quiet_zone_sigma_cells").getDouble();
  estimate.num_samples = query.getColumn("num_samples").getInt();
  estimate.noise_gray = query.getColumn("noise_gray").getDouble();
  estimate.inset_sigma_px = query.getColumn("inset_sigma_px").getDouble();
  return estimate;
}

}  // namespace velamap
