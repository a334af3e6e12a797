#include "importer/layout/dictionary.h"

#include <fstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

std::string WriteDictionary(const TempDir& dir, const std::string& text) {
  const std::string path = dir / "dictionary.yml";
  std::ofstream(path) << "%YAML:1.0\n---\n" << text;
  return path;
}

constexpr char k3x3[] =
    "nmarkers: 2\nmarkersize: 3\nmaxCorrectionBits: 0\n"
    "marker_0: \"110100001\"\nmarker_1: \"111000100\"\n";

TEST(LoadDictionary, KnowsEveryPredefinedName) {
  const std::vector<std::string> names = PredefinedDictionaryNames();
  EXPECT_EQ(names.size(), 22u);  // 21 of OpenCV and that of the thesis
  for (const std::string& name : names) EXPECT_EQ(LoadDictionary(name).name, name);
  EXPECT_EQ(LoadDictionary("4x4_50").name, "DICT_4X4_50");
  EXPECT_EQ(LoadDictionary("dict_apriltag_36H11").name, "DICT_APRILTAG_36h11");
  EXPECT_EQ(LoadDictionary("DICT_6X6_250").aruco->bytesList.rows, 250);
  EXPECT_EQ(LoadDictionary("DICT_APRILTAG_36h10").aruco->bytesList.rows, 2320);
}

TEST(LoadDictionary, ThesisDictionaryIsKnownByName) {
  const Dictionary dictionary = LoadDictionary("thesis_3x3_130");
  EXPECT_EQ(dictionary.name, "THESIS_3X3_130");
  EXPECT_EQ(dictionary.aruco->markerSize, 3);
  EXPECT_EQ(NumMarkers(dictionary), 130);
  EXPECT_FALSE(IsOpenCvName(dictionary.name));
  EXPECT_TRUE(IsOpenCvName("4x4_50"));
}

TEST(DictionaryText, ReadsBackAsItWas) {
  const TempDir dir;
  std::vector<Dictionary> dictionaries;
  for (const std::string& name : PredefinedDictionaryNames()) {
    // Comparing a thousand codes or more takes a while.
    if (NumMarkers(LoadDictionary(name)) < 1000) dictionaries.push_back(LoadDictionary(name));
  }
  CodeSearchOptions options;
  options.bits_per_side = 8;
  options.num_codes = 5;
  dictionaries.push_back(MakeDictionary("mine", FindCodes(options, 1)));
  for (const Dictionary& dictionary : dictionaries) {
    const std::string path = dir / (dictionary.name + ".yml");
    std::ofstream(path) << DictionaryText(dictionary);
    const Dictionary read = LoadDictionary(path);
    ASSERT_EQ(NumMarkers(read), NumMarkers(dictionary)) << dictionary.name;
    EXPECT_EQ(read.aruco->markerSize, dictionary.aruco->markerSize) << dictionary.name;
    EXPECT_EQ(cv::norm(read.aruco->bytesList, dictionary.aruco->bytesList, cv::NORM_L1), 0)
        << dictionary.name;
    cv::FileStorage storage(path, cv::FileStorage::READ);
    cv::aruco::Dictionary opencv;
    EXPECT_TRUE(opencv.readDictionary(storage.root())) << dictionary.name;
    EXPECT_EQ(cv::norm(opencv.bytesList, dictionary.aruco->bytesList, cv::NORM_L1), 0)
        << dictionary.name;
  }
}

TEST(LoadDictionary, UnknownNameListsTheKnownOnes) {
  ExpectThrows<InputError>([] { LoadDictionary("DICT_9X9_50"); },
                           {"'DICT_9X9_50'", "DICT_4X4_50", "DICT_APRILTAG_36h11"});
}

TEST(LoadDictionary, FileOfThreeByThreeBitsKeepsBitsInAllRotations) {
  const TempDir dir;
  const Dictionary dictionary = LoadDictionary(WriteDictionary(dir, k3x3));
  EXPECT_EQ(dictionary.name, "dictionary.yml");
  EXPECT_EQ(dictionary.aruco->markerSize, 3);
  cv::Mat bits = (cv::Mat_<std::uint8_t>(3, 3) << 1, 1, 0, 1, 0, 0, 0, 0, 1);
  for (int turns = 0; turns < 4; ++turns) {
    int id = -1, rotation = -1;
    ASSERT_TRUE(dictionary.aruco->identify(bits, id, rotation, 1.0)) << turns;
    EXPECT_EQ(id, 0);
    EXPECT_EQ(rotation, turns);
    cv::rotate(bits, bits, cv::ROTATE_90_COUNTERCLOCKWISE);
  }
}

TEST(LoadDictionary, FileErrorsNameTheKey) {
  const TempDir dir;
  const auto expect = [&](const std::string& text, const std::string& key,
                          const std::string& part) {
    const std::string path = WriteDictionary(dir, text);
    ExpectThrows<InputError>([&] { LoadDictionary(path); }, {path, "'" + key + "'", part});
  };
  const std::string head = "nmarkers: 2\nmarkersize: 3\nmarker_0: \"110100001\"\n";
  expect("markersize: 3\n", "nmarkers", "missing");
  expect("nmarkers: 0\nmarkersize: 3\n", "nmarkers", "from 1");
  expect("nmarkers: 1\nmarkersize: 2\n", "markersize", "from 3");
  expect("nmarkers: 1\nmarkersize: 3\nmaxCorrectionBits: -1\n", "maxCorrectionBits", "from 0");
  expect(head, "marker_1", "missing");
  expect(head + "marker_1: \"1110001\"\n", "marker_1", "3x3 bits are expected, found 7");
  expect(head + "marker_1: \"11100010x\"\n", "marker_1", "found 'x'");
  expect(head + "marker_1: 111000100\n", "marker_1", "quotes");
  // marker_0 turned by 90 degrees clockwise: rows 010 / 001 / 100 -> columns from the bottom up.
  expect(head + "marker_1: \"011001100\"\n", "marker_1", "the same as marker_0 turned by 90");
  const std::string path = dir / "no.yml";
  std::ofstream(path) << "this is no dictionary";
  ExpectThrows<InputError>([&] { LoadDictionary(path); },
                           {path, "not a readable cv::aruco dictionary file"});
}

TEST(LoadDictionary, ErrorCorrectionNeverConfusesMarkers) {
  const TempDir dir;
  std::string text = k3x3;
  text.replace(text.find("Bits: 0"), 7, "Bits: 4");
  // The two codes differ in fewer than 2 * 4 + 1 bits.
  EXPECT_LT(LoadDictionary(WriteDictionary(dir, text)).aruco->maxCorrectionBits, 4);
}

}  // namespace
}  // namespace velamap
