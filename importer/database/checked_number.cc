#include "importer/database/checked_number.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/text/csv.h"

namespace velamap {

void ThrowDamagedTable(const TablePlace& place, const std::string& what) {
  throw InputError(fmt::format("{}: table {}: {}; delete the database and import again", place.path,
                               place.table, what));
}

double CheckedNumber(const TablePlace& place, const char* column, const OptionRange& range,
                     SQLite::Statement* row) {
  const SQLite::Column found = row->getColumn(column);
  const bool is_number = found.isFloat() || found.isInteger();
  const double value = found.getDouble();
  if (is_number && value >= range.min && value <= range.max) return value;
  ThrowDamagedTable(place, fmt::format("{} is '{}', not a number from {} to {}", column,
                                       SingleLine(found.getString()), range.min, range.max));
}

}  // namespace velamap
