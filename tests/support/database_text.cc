#include "tests/support/database_text.h"

#include <set>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

namespace velamap {

std::string DatabaseText(const std::string& path) {
  SQLite::Database database(path, SQLite::OPEN_READONLY);
  EXPECT_EQ(database.execAndGet("PRAGMA integrity_check").getString(), "ok");
  std::vector<std::string> tables;
  SQLite::Statement names(database, "SELECT name FROM sqlite_master WHERE type = 'table'");
  while (names.executeStep()) tables.push_back(names.getColumn(0).getString());
  std::multiset<std::string> lines;
  for (const std::string& table : tables) {
    lines.insert(table);
    SQLite::Statement rows(database, "SELECT * FROM \"" + table + '"');
    while (rows.executeStep()) {
      std::string line = table;
      for (int i = 0; i < rows.getColumnCount(); ++i) line += '|' + rows.getColumn(i).getString();
      lines.insert(line);
    }
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace velamap
