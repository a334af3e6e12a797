// Validates the values in velamap's own tables, because another program may have edited them.

#pragma once

#include <string>

#include "importer/base/option.h"

namespace SQLite {
class Statement;
}

namespace velamap {

// The place of a value, for messages.
struct TablePlace {
  const std::string& path;  // of the database
  const char* table;
};

// Throws InputError that names the table, what is wrong with it, and the remedy.
[[noreturn]] void ThrowDamagedTable(const TablePlace& place, const std::string& what);

// Throws InputError for a value that is not a number within the range.
double CheckedNumber(const TablePlace& place, const char* column, const OptionRange& range,
                     SQLite::Statement* row);

}  // namespace velamap
