// Writes the seeds of all fuzz targets: make_seeds FOLDER, a folder for each reader.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/readers.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_seeds FOLDER\n", stderr);
    return 2;
  }
  for (const auto& [name, reader] : velamap::FuzzedReaders()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / name;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const std::string& seed : reader.make_seeds()) {
      std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
    }
  }
  return 0;
}
