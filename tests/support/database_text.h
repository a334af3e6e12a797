// The content of a database, to be compared with that of another one.

#pragma once

#include <string>

namespace velamap {

// A line for each row of each table, sorted: the same content may lie in other places of the file.
// Fails the test if SQLite finds the file damaged.
std::string DatabaseText(const std::string& path);

}  // namespace velamap
