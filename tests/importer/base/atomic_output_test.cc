#include "importer/base/atomic_output.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string Content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

int NumEntries(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(WriteFileAtomically, WritesClassicLocaleAndFullPrecision) {
  const TempDir dir;
  WriteFileAtomically(dir / "a.txt", [](std::ostream& stream) { stream << 0.1 << '\n' << 10000; });
  EXPECT_EQ(Content(dir / "a.txt"), "0.10000000000000001\n10000");
  EXPECT_EQ(NumEntries(dir.path()), 1);
}

TEST(WriteFileAtomically, FailureLeavesTheOldFileAndNothingElse) {
  const TempDir dir;
  WriteFile(dir / "a.txt", [](std::ostream& stream) { stream << "old"; });
  EXPECT_THROW(WriteFileAtomically(dir / "a.txt",
                                   [](std::ostream& stream) {
                                     stream << "new";
                                     throw std::runtime_error("stop");
                                   }),
               std::runtime_error);
  EXPECT_EQ(Content(dir / "a.txt"), "old");
  ExpectThrows<InputError>(
      [&] {
        WriteFileAtomically(dir / "a.txt",
                            [](std::ostream& stream) { stream.setstate(std::ios::badbit); });
      },
      {dir / "a.txt", "cannot be written"});
  EXPECT_EQ(Content(dir / "a.txt"), "old");
  EXPECT_EQ(NumEntries(dir.path()), 1);
}

TEST(WriteFileAtomically, KeepsALinkAndRefusesOtherThanFiles) {
  const TempDir dir;
  WriteFile(dir / "target", [](std::ostream& stream) { stream << "old"; });
  fs::create_symlink(dir / "target", dir / "link");
  WriteFileAtomically(dir / "link", [](std::ostream& stream) { stream << "new"; });
  EXPECT_TRUE(fs::is_symlink(dir / "link"));
  EXPECT_EQ(Content(dir / "target"), "new");
  const auto nothing = [](std::ostream&) {};
  ExpectThrows<InputError>([&] { WriteFileAtomically(dir.path(), nothing); },
                           {dir.path(), "not a regular file"});
  ExpectThrows<InputError>([&] { WriteFileAtomically("/dev/full", nothing); }, {"/dev/full"});
  ExpectThrows<InputError>([&] { WriteFileAtomically(dir / "target" / "x", nothing); },
                           {dir / "target", "cannot be written"});
}

TEST(WriteFile, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  ExpectThrows<InputError>([] { WriteFile("/dev/full", [](std::ostream& s) { s << "x"; }); },
                           {"/dev/full", "No space left"});
}

TEST(AtomicFolder, ReplacesOnCommit) {
  const TempDir dir;
  for (const char* text : {"first", "second"}) {
    AtomicFolder folder(dir / "parent/out/");
    WriteFile(folder.TemporaryPath() / "a.txt", [&](std::ostream& stream) { stream << text; });
    if (fs::exists(dir / "parent/out")) {
      EXPECT_EQ(Content(dir / "parent/out/a.txt"), "first");
    }
    folder.Commit();
    EXPECT_EQ(Content(dir / "parent/out/a.txt"), text);
  }
  EXPECT_EQ(NumEntries(dir / "parent"), 1);
}

TEST(AtomicFolder, WithoutCommitTheOldOneStays) {
  const TempDir dir;
  {
    AtomicFolder folder(dir / "out");
    WriteFile(folder.TemporaryPath() / "a.txt", [](std::ostream& stream) { stream << "old"; });
    folder.Commit();
  }
  {
    const AtomicFolder folder(dir / "out");
    WriteFile(folder.TemporaryPath() / "a.txt", [](std::ostream& stream) { stream << "new"; });
  }
  EXPECT_EQ(Content(dir / "out" / "a.txt"), "old");
  EXPECT_EQ(NumEntries(dir.path()), 1);
}

TEST(AtomicFolder, KnowsWhatItWroteInSubfolders) {
  const TempDir dir;
  const auto write = [&] {
    AtomicFolder folder(dir / "out");
    fs::create_directory(folder.TemporaryPath() / "markers");
    WriteFile(folder.TemporaryPath() / "markers/a.svg", [](std::ostream& out) { out << "<svg/>"; });
    folder.Commit();
  };
  write();
  write();
  EXPECT_EQ(Content(dir / "out/markers/a.svg"), "<svg/>");
  WriteFile(dir / "out/markers/photo.jpg", [](std::ostream& out) { out << "mine"; });
  ExpectThrows<InputError>(write, {"photo.jpg", "did not write there"});
  EXPECT_EQ(Content(dir / "out/markers/photo.jpg"), "mine");
}

TEST(AtomicFolder, RefusesAFile) {
  const TempDir dir;
  WriteFile(dir / "out", [](std::ostream&) {});
  ExpectThrows<InputError>([&] { AtomicFolder folder(dir / "out"); },
                           {dir / "out", "not a folder"});
  ExpectThrows<InputError>([&] { AtomicFolder folder(dir / "out" / "x"); }, {"cannot be written"});
}

}  // namespace
}  // namespace velamap
