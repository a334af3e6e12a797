// Arrays of numbers as blobs in SQLite's columns, in the machine's byte order, as in COLMAP.

#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

namespace velamap {

template <typename T>
void BindBlob(SQLite::Statement& statement, int index, const std::vector<T>& values) {
  // An empty vector has no address, and SQLite takes a null address for NULL.
  static constexpr char kNothing = 0;
  const void* data = values.empty() ? static_cast<const void*>(&kNothing) : values.data();
  statement.bind(index, data, static_cast<int>(values.size() * sizeof(T)));
}

template <typename T>
std::vector<T> ReadBlob(const SQLite::Column& column) {
  std::vector<T> values(static_cast<std::size_t>(column.getBytes()) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), column.getBlob(), values.size() * sizeof(T));
  return values;
}

}  // namespace velamap
