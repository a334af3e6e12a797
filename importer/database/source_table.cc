#include "importer/database/source_table.h"

#include <cstdint>
#include <filesystem>

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include "importer/base/files.h"
#include "importer/database/colmap_schema.h"

namespace velamap {
namespace {

constexpr char kSourceSchema[] = R"(
CREATE TABLE marker_sources (
    image_name TEXT PRIMARY KEY NOT NULL,
    path TEXT NOT NULL,
    path_hash INTEGER NOT NULL,
    size INTEGER NOT NULL,
    modified_s INTEGER NOT NULL,
    changed_ns INTEGER NOT NULL,
    content_hash INTEGER NOT NULL);
)";

// Whether there is a table with this column, which one of an earlier velamap may lack.
bool HasSourceColumn(const SQLite::Database& database, const std::string& column) {
  return ColumnNames(database, "marker_sources").count(column) > 0;
}

void Insert(const std::string& image_name, const SourceFile& source, SQLite::Database* database) {
  SQLite::Statement insert(*database,
                           "INSERT OR REPLACE INTO marker_sources(image_name, path, path_hash,"
                           " size, modified_s, changed_ns, content_hash)"
                           " VALUES(?, ?, ?, ?, ?, ?, ?)");
  // SQLite's numbers are signed.
  SQLite::bind(insert, image_name, source.name, static_cast<std::int64_t>(source.path_hash),
               static_cast<std::int64_t>(source.size), source.modified_s, source.changed_ns,
               static_cast<std::int64_t>(source.content_hash));
  insert.exec();
}

// Creates the table, or brings one of an earlier velamap up to date.
void MakeTable(SQLite::Database* database) {
  const std::map<std::string, SourceFile> earlier = ReadSourceRows(database);
  database->exec("DROP TABLE IF EXISTS marker_sources");
  database->exec(kSourceSchema);
  for (const auto& [image_name, source] : earlier) Insert(image_name, source, database);
}

}  // namespace

void WriteSourceRow(const std::string& image_name, const SourceFile& source,
                    SQLite::Database* database) {
  if (!HasSourceColumn(*database, "path_hash")) MakeTable(database);
  Insert(image_name, source, database);
}

std::map<std::string, SourceFile> ReadSourceRows(SQLite::Database* database) {
  std::map<std::string, SourceFile> sources;
  if (!HasSourceColumn(*database, "content_hash")) return sources;
  // Velamap 0.1 wrote absolute paths and no hash of them.
  const bool has_hash = HasSourceColumn(*database, "path_hash");
  SQLite::Statement query(*database,
                          fmt::format("SELECT image_name, path, size, modified_s, changed_ns,"
                                      " content_hash, {} FROM marker_sources",
                                      has_hash ? "path_hash" : "NULL"));
  while (query.executeStep()) {
    SourceFile& source = sources[query.getColumn(0).getString()];
    const std::string path = query.getColumn(1).getString();
    source.name = std::filesystem::path(path).filename().string();
    source.path_hash =
        has_hash ? static_cast<std::uint64_t>(query.getColumn(6).getInt64()) : Hash(path);
    source.size = static_cast<std::uint64_t>(query.getColumn(2).getInt64());
    source.modified_s = query.getColumn(3).getInt64();
    source.changed_ns = query.getColumn(4).getInt64();
    source.content_hash = static_cast<std::uint64_t>(query.getColumn(5).getInt64());
  }
  return sources;
}

}  // namespace velamap
