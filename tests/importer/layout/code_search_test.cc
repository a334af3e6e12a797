#include "importer/layout/code_search.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/layout/dictionary.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

// As rows of '0' and '1', so that these checks share nothing with the search's bit arithmetic.
std::string Cells(MarkerCode code, int bits) {
  std::string cells;
  for (int i = 0; i < bits * bits; ++i) cells += (code >> i & 1) != 0 ? '1' : '0';
  return cells;
}

std::string Turned(const std::string& cells, int bits) {
  std::string turned(cells.size(), ' ');
  for (int row = 0; row < bits; ++row) {
    for (int column = 0; column < bits; ++column) {
      turned[static_cast<std::size_t>(bits * column + bits - 1 - row)] =
          cells[static_cast<std::size_t>(bits * row + column)];
    }
  }
  return turned;
}

int NumDifferent(const std::string& a, const std::string& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

struct BruteForce {
  int min_distance = 100;       // between two codes
  int min_turn_distance = 100;  // of a code from itself, turned
};

BruteForce CompareAll(const std::vector<std::string>& codes, int bits) {
  BruteForce found;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    std::string turned = codes[i];
    for (int turns = 0; turns < 4; ++turns) {
      if (turns > 0) {
        found.min_turn_distance = std::min(found.min_turn_distance, NumDifferent(turned, codes[i]));
      }
      for (std::size_t j = 0; j < codes.size(); ++j) {
        if (i != j)
          found.min_distance = std::min(found.min_distance, NumDifferent(turned, codes[j]));
      }
      turned = Turned(turned, bits);
    }
  }
  return found;
}

std::vector<std::string> CellsOf(const CodeSet& set) {
  std::vector<std::string> codes;
  for (const MarkerCode code : set.codes) codes.push_back(Cells(code, set.bits_per_side));
  return codes;
}

CodeSearchOptions Options(int bits, int num_codes, bool allow_symmetric = false) {
  CodeSearchOptions options;
  options.bits_per_side = bits;
  options.num_codes = num_codes;
  options.allow_symmetric = allow_symmetric;
  return options;
}

TEST(FindCodes, DistanceHoldsAgainstBruteForce) {
  for (int bits = 3; bits <= 8; ++bits) {
    const CodeSet set = FindCodes(Options(bits, 10), 7);
    ASSERT_EQ(set.codes.size(), 10u);
    const BruteForce found = CompareAll(CellsOf(set), bits);
    EXPECT_EQ(set.min_distance, found.min_distance) << bits;
    EXPECT_GE(found.min_distance, 2) << bits;
    EXPECT_GE(found.min_turn_distance, std::min(found.min_distance, 2)) << bits;
    EXPECT_EQ(set.num_symmetric, 0) << bits;
  }
}

TEST(FindCodes, ReachesTheDistanceOfOpenCvsDictionaries) {
  for (const char* name : {"DICT_4X4_50", "DICT_5X5_50", "DICT_6X6_50", "DICT_7X7_50"}) {
    const Dictionary dictionary = LoadDictionary(name);
    const int bits = dictionary.aruco->markerSize;
    std::vector<std::string> codes;
    for (int id = 0; id < NumMarkers(dictionary); ++id) {
      const cv::Mat cells = MarkerCells(dictionary, id, 1);
      std::string& code = codes.emplace_back();
      for (int i = 0; i < bits * bits; ++i) {
        code += cells.at<std::uint8_t>(1 + i / bits, 1 + i % bits) != 0 ? '1' : '0';
      }
    }
    const CodeSet set = FindCodes(Options(bits, NumMarkers(dictionary)), 0);
    EXPECT_GE(set.min_distance, CompareAll(codes, bits).min_distance) << name;
  }
}

TEST(FindCodes, SameSeedSameCodes) {
  const CodeSet first = FindCodes(Options(5, 10), 3);
  EXPECT_EQ(FindCodes(Options(5, 10), 3).codes, first.codes);
  EXPECT_NE(FindCodes(Options(5, 10), 4).codes, first.codes);
}

TEST(FindCodes, ThreeByThreeBitsHave120CodesWithoutSymmetryAnd140InAll) {
  EXPECT_EQ(NumAsymmetricCodes(3), 120);
  const BruteForce all = CompareAll(CellsOf(FindCodes(Options(3, 120), 1)), 3);
  EXPECT_GE(all.min_distance, 1);
  EXPECT_GE(all.min_turn_distance, 1);
  ExpectThrows<InputError>([] { FindCodes(Options(3, 121), 1); },
                           {"--CustomDictionary.bits", "121", "120", "allow_symmetric 1"});
  const CodeSet symmetric = FindCodes(Options(3, 140, true), 1);
  EXPECT_EQ(symmetric.num_symmetric, 20);
  EXPECT_GE(CompareAll(CellsOf(symmetric), 3).min_distance, 1);
  ExpectThrows<InputError>([] { FindCodes(Options(3, 141, true), 1); },
                           {"--CustomDictionary.bits", "141", "140 in all"});
}

TEST(CodeSearchOptions, BitsHaveALimit) {
  EXPECT_NO_THROW(Options(0, 0).Check());
  ExpectThrows<InputError>([] { Options(2, 5).Check(); }, {"--CustomDictionary.bits: 2", "3 to 8"});
  ExpectThrows<InputError>([] { Options(9, 5).Check(); }, {"--CustomDictionary.bits: 9"});
}

TEST(ThesisCodes, AreAllCodesWithoutSymmetryAndTenOthers) {
  const CodeSet set = ThesisCodes();
  EXPECT_EQ(set.codes.size(), 130u);
  EXPECT_EQ(set.bits_per_side, 3);
  EXPECT_EQ(set.num_symmetric, 10);
  const std::vector<std::string> codes = CellsOf(set);
  EXPECT_GE(CompareAll(codes, 3).min_distance, 1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    // None looks the same after a quarter turn.
    EXPECT_NE(Turned(codes[i], 3), codes[i]) << i;
    EXPECT_EQ(Turned(Turned(codes[i], 3), 3) == codes[i], i >= 120) << i;
  }
  // The codes stay as they are: markers have been printed.
  EXPECT_EQ(codes.front(), "100000000");
  EXPECT_EQ(std::set<std::string>(codes.begin(), codes.end()).size(), 130u);
}

}  // namespace
}  // namespace velamap
