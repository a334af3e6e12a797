// Recognizes and creates the tables of a COLMAP 3.8 database, and those that velamap adds.

#pragma once

#include <set>
#include <string>

namespace SQLite {
class Database;
}

namespace velamap {

// Throws InputError, naming the path, for faults that SQLite would report less clearly or hide by
// creating a file: a missing file or, when writing, its missing folder; not a regular file; not an
// SQLite file.
void CheckDatabaseFile(const std::string& path, bool writing);

// Throws InputError if a table of COLMAP is missing.
void CheckColmapTables(const std::string& path, const SQLite::Database& database);

// Empty if there is no such table.
std::set<std::string> ColumnNames(const SQLite::Database& database, const std::string& table);

// Whether the database has no tables at all.
bool IsFresh(const SQLite::Database& database);

// Creates all tables in a fresh database.
void CreateTables(SQLite::Database* database);

// Throws InputError, and writes nothing, unless images can be added: for a database of another
// program, for the schemas of COLMAP 3.10 and later, and for one whose images velamap has not
// imported.
void CheckCanBeAddedTo(const std::string& path, SQLite::Database* database);

// The same for a database with a journal or a write-ahead log beside it, as a program leaves them
// when it is interrupted or still runs. To open such a database is to change it, so this looks at a
// copy. Does nothing if there are no such files.
void CheckUnfinishedCanBeAddedTo(const std::string& path);

}  // namespace velamap
