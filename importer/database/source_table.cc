#include "importer/database/source_table.h"

#include <cstdint>

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>

namespace velamap {
namespace {

constexpr char kSchema[] = R"(
CREATE TABLE IF NOT EXISTS marker_sources (
    image_name TEXT PRIMARY KEY NOT NULL,
    path TEXT NOT NULL,
    size INTEGER NOT NULL,
    modified_s INTEGER NOT NULL,
    parts_hash INTEGER NOT NULL);
)";

}  // namespace

void WriteSourceRow(const std::string& image_name, const SourceFile& source,
                    SQLite::Database* database) {
  database->exec(kSchema);
  SQLite::Statement insert(*database,
                           "INSERT OR REPLACE INTO marker_sources(image_name, path, size,"
                           " modified_s, parts_hash) VALUES(?, ?, ?, ?, ?)");
  // SQLite's numbers are signed.
  SQLite::bind(insert, image_name, source.path, static_cast<std::int64_t>(source.size),
               source.modified_s, static_cast<std::int64_t>(source.parts_hash));
  insert.exec();
}

std::map<std::string, SourceFile> ReadSourceRows(SQLite::Database* database) {
  std::map<std::string, SourceFile> sources;
  if (!database->tableExists("marker_sources")) return sources;
  SQLite::Statement query(
      *database, "SELECT image_name, path, size, modified_s, parts_hash FROM marker_sources");
  while (query.executeStep()) {
    SourceFile& source = sources[query.getColumn(0).getString()];
    source.path = query.getColumn(1).getString();
    source.size = static_cast<std::uint64_t>(query.getColumn(2).getInt64());
    source.modified_s = query.getColumn(3).getInt64();
    source.parts_hash = static_cast<std::uint64_t>(query.getColumn(4).getInt64());
  }
  return sources;
}

}  // namespace velamap
