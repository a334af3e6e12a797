#include "importer/database/sqlite_errors.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include "importer/base/error.h"

namespace velamap {

void ThrowInputError(const std::string& path, const SQLite::Exception& exception) {
  std::string message;
  switch (exception.getErrorCode()) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      message = "locked by another program; close it (the COLMAP GUI?) and run again";
      break;
    case SQLITE_FULL:
      message = "cannot be written: the disk is full";
      break;
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      message = "cannot be opened for writing; check the folder and its permissions";
      break;
    case SQLITE_NOTADB:
      message = "no SQLite database";
      break;
    case SQLITE_CORRUPT:
      message = "a damaged database; delete it and import again";
      break;
    default:
      message = fmt::format(
          "SQLite reports: {}; give a database of velamap marker_importer, or delete it and import "
          "again",
          exception.what());
  }
  throw InputError(fmt::format("{}: {}", path, message));
}

}  // namespace velamap
