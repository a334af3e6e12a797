// Input errors that name the database: those of SQLite, and an image that it holds twice.

#pragma once

#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

namespace velamap {

// Throws InputError: one line with a remedy.
[[noreturn]] void ThrowInputError(const std::string& path, const SQLite::Exception& exception);

// Throws InputError: two rows of the table of images have this name.
[[noreturn]] void ThrowDoubleImageName(const std::string& path, const std::string& image_name);

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
