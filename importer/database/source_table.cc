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
    changed_ns INTEGER NOT NULL,
    content_hash INTEGER NOT NULL);
)";

// Whether there is a table with all columns, which one of an earlier velamap lacks.
bool HasTable(SQLite::Database* database) {
  SQLite::Statement query(*database,
                          "SELECT count(*) FROM pragma_table_info('marker_sources')"
                          " WHERE name = 'content_hash'");
  return query.executeStep() && query.getColumn(0).getInt() > 0;
}

}  // namespace

void WriteSourceRow(const std::string& image_name, const SourceFile& source,
                    SQLite::Database* database) {
  if (!HasTable(database)) database->exec("DROP TABLE IF EXISTS marker_sources");
  database->exec(kSchema);
  SQLite::Statement insert(*database,
                           "INSERT OR REPLACE INTO marker_sources(image_name, path, size,"
                           " modified_s, changed_ns, content_hash) VALUES(?, ?, ?, ?, ?, ?)");
  // SQLite's numbers are signed.
  SQLite::bind(insert, image_name, source.path, static_cast<std::int64_t>(source.size),
               source.modified_s, source.changed_ns,
               static_cast<std::int64_t>(source.content_hash));
  insert.exec();
}

std::map<std::string, SourceFile> ReadSourceRows(SQLite::Database* database) {
  std::map<std::string, SourceFile> sources;
  if (!HasTable(database)) return sources;
  SQLite::Statement query(*database,
                          "SELECT image_name, path, size, modified_s, changed_ns, content_hash"
                          " FROM marker_sources");
  while (query.executeStep()) {
    SourceFile& source = sources[query.getColumn(0).getString()];
    source.path = query.getColumn(1).getString();
    source.size = static_cast<std::uint64_t>(query.getColumn(2).getInt64());
    source.modified_s = query.getColumn(3).getInt64();
    source.changed_ns = query.getColumn(4).getInt64();
    source.content_hash = static_cast<std::uint64_t>(query.getColumn(5).getInt64());
  }
  return sources;
}

}  // namespace velamap
