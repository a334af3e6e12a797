#include "tests/support/temp_dir.h"

#include <stdlib.h>

#include <stdexcept>

namespace velamap {

TempDir::TempDir() {
  std::string pattern = (std::filesystem::temp_directory_path() / "velamap_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed: " + pattern);
  path_ = pattern;
}

TempDir::~TempDir() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace velamap
