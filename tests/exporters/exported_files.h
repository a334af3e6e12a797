// Where the tests of the exporter write, and what they find there.

#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "exporters/shape_exporter.h"
#include "tests/exporters/golden_file.h"
#include "tests/support/temp_dir.h"

namespace velamap {

namespace fs = std::filesystem;

inline std::set<std::string> FilesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

// Contents of a folder's files, by name. shape.json, STEP and IGES have the date: see
// scoped_date.h.
inline std::map<std::string, std::string> BytesIn(const fs::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const std::string& name : FilesIn(folder)) bytes[name] = ReadBytes(folder / name);
  return bytes;
}

inline ShapeExporterOptions OptionsIn(const TempDir& dir) {
  ShapeExporterOptions options;
  options.model_output_path = dir / "0";
  options.shape_output_path = dir / "shape";
  return options;
}

}  // namespace velamap
