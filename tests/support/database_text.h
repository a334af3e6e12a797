// The content of a database as text, for comparison with another database.

#pragma once

#include <string>

namespace velamap {

// One line for each row of each table. The lines are sorted because the same content can be stored
// in a different order. Fails the test if SQLite finds the file damaged.
std::string DatabaseText(const std::string& path);

}  // namespace velamap
