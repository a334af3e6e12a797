// The seeds of all fuzz targets are read, and what they once found is refused or read. Run with the
// unit tests, without libFuzzer.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/design/mesh_reader.h"
#include "importer/base/error.h"
#include "tests/fuzz/readers.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

fs::path FindingsOf(const std::string& reader) { return fs::path(VELAMAP_FUZZ_FINDINGS) / reader; }

class FuzzTest : public ::testing::TestWithParam<std::string> {
 protected:
  const FuzzedReader& reader_ = FuzzedReaders().at(GetParam());

  // Fails unless the bytes are read or refused.
  void Read(const std::string& bytes, const std::string& what) const {
    try {
      reader_.read(bytes);
    } catch (const InputError&) {
    } catch (const DataError&) {
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": " << error.what();
    }
  }
};

TEST_P(FuzzTest, SeedsAreGood) {
  const std::vector<std::string> seeds = reader_.make_seeds();
  ASSERT_FALSE(seeds.empty());
  for (const std::string& seed : seeds) EXPECT_NO_THROW(reader_.read(seed)) << seed.substr(0, 40);
}

TEST_P(FuzzTest, CutOffAndChangedSeedsAreRefusedOrRead) {
  constexpr int kNumChanges = 12;
  std::mt19937 random(1);
  for (const std::string& seed : reader_.make_seeds()) {
    for (int i = 0; i < kNumChanges; ++i) {
      Read(seed.substr(0, random() % seed.size()), "a seed cut off");
      std::string changed = seed;
      changed[random() % changed.size()] = static_cast<char>(random());
      Read(changed, "a changed seed");
    }
  }
}

// Readers in which the fuzzers found something.
class FuzzFindings : public FuzzTest {};

TEST_P(FuzzFindings, AreRefusedOrRead) {
  for (const fs::directory_entry& file : fs::directory_iterator(FindingsOf(GetParam()))) {
    std::ifstream in(file.path(), std::ios::binary);
    Read({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()},
         file.path().string());
  }
}

std::vector<std::string> Names(bool with_findings_only) {
  std::vector<std::string> names;
  for (const auto& [name, reader] : FuzzedReaders()) {
    if (!with_findings_only || fs::exists(FindingsOf(name))) names.push_back(name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzTest, ::testing::ValuesIn(Names(false)),
                         [](const auto& reader) { return reader.param; });
INSTANTIATE_TEST_SUITE_P(Readers, FuzzFindings, ::testing::ValuesIn(Names(true)),
                         [](const auto& reader) { return reader.param; });

}  // namespace
}  // namespace velamap
