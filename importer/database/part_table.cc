#include "importer/database/part_table.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include "importer/database/checked_number.h"

namespace velamap {
namespace {

constexpr char kPartSchema[] = R"(
CREATE TABLE IF NOT EXISTS marker_part (
    part INTEGER NOT NULL,
    num_parts INTEGER NOT NULL,
    first_frame INTEGER NOT NULL,
    last_frame INTEGER NOT NULL,
    frame_step INTEGER NOT NULL,
    detector TEXT NOT NULL,
    is_finished INTEGER NOT NULL);
DELETE FROM marker_part;
)";

}  // namespace

std::string PartText(const VideoPart& part) {
  return fmt::format("{}/{}", part.number, part.count);
}

void WritePart(const PartRecord& record, SQLite::Database* database) {
  database->exec(kPartSchema);
  SQLite::Statement insert(*database,
                           "INSERT INTO marker_part(part, num_parts, first_frame, last_frame,"
                           " frame_step, detector, is_finished) VALUES(?, ?, ?, ?, ?, ?, ?)");
  SQLite::bind(insert, record.part.number, record.part.count, record.whole.first_frame,
               record.whole.last_frame, record.whole.frame_step, record.detector,
               record.is_finished ? 1 : 0);
  insert.exec();
}

std::optional<PartRecord> ReadPart(const std::string& path, SQLite::Database* database) {
  if (!database->tableExists("marker_part")) return std::nullopt;
  SQLite::Statement row(*database,
                        "SELECT part, num_parts, first_frame, last_frame, frame_step, detector,"
                        " is_finished FROM marker_part");
  if (!row.executeStep()) return std::nullopt;
  const auto number = [&](const char* column, double min, double max) {
    return static_cast<int>(CheckedNumber({path, "marker_part"}, column, FromTo(min, max), &row));
  };
  constexpr int kMax = 1 << 30;
  PartRecord record;
  record.part.count = number("num_parts", 1, kMaxNumParts);
  record.part.number = number("part", 1, record.part.count);
  record.whole.first_frame = number("first_frame", 0, kMax);
  record.whole.last_frame = number("last_frame", -1, kMax);
  record.whole.frame_step = number("frame_step", 1, kMax);
  record.detector = row.getColumn("detector").getString();
  record.is_finished = number("is_finished", 0, 1) != 0;
  return record;
}

}  // namespace velamap
