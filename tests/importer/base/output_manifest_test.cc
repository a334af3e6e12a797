#include "importer/base/output_manifest.h"

#include <fstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/base/text_file.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

const OutputFiles kFiles = {
    {"layout.yml", "a: 1\n"}, {"markers/marker_0001.svg", "<svg/>"}, {"empty", ""}};

class OutputFolderTest : public testing::Test {
 protected:
  void ExpectRefused(const std::string& part) {
    ExpectThrows<InputError>([&] { CheckOutputFolder(folder_); }, {folder_.string(), part});
  }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  TempDir dir_;
  fs::path folder_ = dir_ / "out";
};

TEST_F(OutputFolderTest, IsReplacedAsAWholeIfItIsAsItWasLeft) {
  CheckOutputFolder(folder_);
  WriteOutputFolder(folder_, kFiles);
  EXPECT_EQ(ReadTextFile((folder_ / "markers/marker_0001.svg").string(), ""), "<svg/>");
  CheckOutputFolder(folder_);
  WriteOutputFolder(folder_, {{"layout.yml", "a: 2\n"}});
  EXPECT_FALSE(fs::exists(folder_ / "markers"));
  EXPECT_EQ(ReadTextFile((folder_ / "layout.yml").string(), ""), "a: 2\n");
  CheckOutputFolder(folder_);
}

TEST_F(OutputFolderTest, MayBeEmptyButHoldNothingForeign) {
  fs::create_directory(folder_);
  CheckOutputFolder(folder_);
  Write("sheets.pdf", "mine");
  ExpectRefused("sheets.pdf, which velamap did not write there");
  fs::remove(folder_ / "sheets.pdf");
  WriteOutputFolder(folder_, kFiles);
  Write("markers/photo.jpg", "mine");
  ExpectRefused("markers/photo.jpg, which velamap did not write there");
  fs::remove(folder_ / "markers/photo.jpg");
  Write(".hidden", "mine");
  ExpectRefused(".hidden");
}

TEST_F(OutputFolderTest, EditedFilesAreNotLost) {
  WriteOutputFolder(folder_, kFiles);
  Write("layout.yml", "a: 3\n");
  ExpectRefused("layout.yml has been changed");
  Write("layout.yml", "");
  ExpectRefused("layout.yml has been changed");
  Write("layout.yml", "a: 1\n");
  CheckOutputFolder(folder_);
  Write("empty", "no longer");
  ExpectRefused("empty has been changed");
}

TEST_F(OutputFolderTest, IsNoFileAndNotBelowOne) {
  std::ofstream(folder_) << "file";
  ExpectRefused("is no folder");
  ExpectThrows<InputError>([&] { WriteOutputFolder(folder_ / "below", kFiles); },
                           {folder_.string()});
}

TEST_F(OutputFolderTest, DoesNotReplaceItsInput) {
  WriteOutputFolder(folder_, kFiles);
  const std::string inside = (folder_ / "layout.yml").string();
  ExpectThrows<InputError>([&] { CheckInputOutside(inside, folder_); }, {inside, "replaced"});
  ExpectThrows<InputError>([&] { CheckInputOutside(inside, folder_ / ""); }, {inside});
  CheckInputOutside("", folder_);
  CheckInputOutside("DICT_4X4_50", folder_);
  std::ofstream(dir_ / "out.yml") << "a";
  CheckInputOutside((dir_ / "out.yml").string(), folder_);
}

}  // namespace
}  // namespace velamap
