// Turns the errors of SQLite into input errors that name the database.

#pragma once

#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

namespace velamap {

// Throws InputError: one line with a remedy.
[[noreturn]] void ThrowInputError(const std::string& path, const SQLite::Exception& exception);

// Calls `function` and turns what SQLite throws into an InputError.
template <typename Function>
auto Guarded(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const SQLite::Exception& exception) {
    ThrowInputError(path, exception);
  }
}

}  // namespace velamap
