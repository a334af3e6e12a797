// Every reader of a file that others may have written, for the fuzz targets and their regression
// test: what it does with any bytes.

#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace velamap {

struct FuzzedReader {
  // Writes `bytes` to a file and reads it. Throws InputError or DataError if it is refused;
  // everything else is a finding.
  std::function<void(const std::string& bytes)> read;
  // Good files, small ones.
  std::function<std::vector<std::string>()> make_seeds;
};

// By name. A model has three files: the first byte of the input, 0 to 2, says which of them the
// rest replaces in a good model.
const std::map<std::string, FuzzedReader>& FuzzedReaders();

}  // namespace velamap
