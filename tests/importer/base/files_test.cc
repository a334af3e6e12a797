#include "importer/base/files.h"

#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>

#include <gmock/gmock.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/replacement.h"
#include "importer/text/text_file.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

void Touch(const fs::path& path) { std::ofstream(path) << "x"; }

TEST(Files, TooLongNamesAreInputErrors) {
  const TempDir dir;
  const std::string path = dir / std::string(300, 'n');
  const std::vector<std::function<void()>> calls = {
      [&] { Exists(path); },
      [&] { IsFolder(path); },
      [&] { IsRegularFile(path); },
      [&] { FileSize(path); },
      [&] { CanonicalPath(path); },
      [&] { FolderEntries(path); },
      [&] { FilesBelow(path); },
      [&] { CreateFolders(path); },
      [&] { CloneFile(path, dir / "to"); },
      [&] { AtomicFolder folder(path); },
      [&] { CheckReplaceableFolder(path); },
      [&] { WriteFileAtomically(path, [](std::ostream&) {}); },
      [&] { WriteFile(path, [](std::ostream&) {}); },
      [&] { ReadTextFile(path, "layout file"); }};
  for (const std::function<void()>& call : calls) {
    ExpectThrows<InputError>(call, {path, "File name too long"});
  }
  RemoveAll(path);
  EXPECT_TRUE(fs::is_empty(dir.path()));
}

TEST(Files, WhatIsNotThereIsNoError) {
  const TempDir dir;
  Touch(dir / "file");
  for (const fs::path& path : {fs::path(), dir / "none", dir / "file/below"}) {
    EXPECT_FALSE(Exists(path)) << path;
    EXPECT_FALSE(IsFolder(path)) << path;
    EXPECT_FALSE(IsRegularFile(path)) << path;
  }
  EXPECT_TRUE(IsFolder(dir.path()));
  EXPECT_TRUE(IsRegularFile(dir / "file"));
  EXPECT_EQ(FileSize(dir / "file"), 1u);
  ExpectThrows<InputError>([&] { FileSize(dir / "none"); }, {dir / "none", "No such file"});
  ExpectThrows<InputError>([&] { CreateFolders(dir / "file"); }, {dir / "file"});
}

TEST(Files, FoldersAreAbsoluteAndWithoutTrailingSlash) {
  EXPECT_EQ(AbsoluteFolder("/a/./b/../c/"), "/a/c");
  EXPECT_EQ(AbsoluteFolder("/a/c"), "/a/c");
  EXPECT_EQ(AbsoluteFolder("c"), fs::current_path() / "c");
  EXPECT_THROW(AbsoluteFolder(""), InputError);
}

TEST(Files, TheFolderAboveALinkIsThatOfItsTarget) {
  const TempDir dir;
  const fs::path folder = fs::canonical(dir.path());
  fs::create_directories(folder / "other/deep");
  fs::create_directory_symlink("other/deep", folder / "link");
  EXPECT_EQ(AbsolutePath(folder / "link/../a.csv"), folder / "other/a.csv");
  Touch(folder / "a.csv");
  WriteFileAtomically(folder / "link/../a.csv", [](std::ostream& out) { out << "new"; });
  EXPECT_EQ(FileSize(folder / "a.csv"), 1u);
  EXPECT_EQ(FileSize(folder / "other/a.csv"), 3u);
}

TEST(Files, ALinkLeadsWhereItsFileWillBeWritten) {
  const TempDir dir;
  const fs::path folder = fs::canonical(dir.path());
  fs::create_directories(folder / "other");
  fs::create_symlink("other/new", folder / "link");  // to what is not there yet
  fs::create_symlink(folder / "link", folder / "again");
  fs::create_symlink("circle", folder / "circle");
  EXPECT_EQ(CanonicalPath(folder / "again"), folder / "other/new");
  EXPECT_EQ(CanonicalPath(folder / "none/../link/./a/"), folder / "other/new/a");
  EXPECT_EQ(CanonicalPath("/../tmp"), fs::canonical("/tmp"));
  ExpectThrows<InputError>([&] { CanonicalPath(folder / "circle/a"); },
                           {folder / "circle/a", "levels of symbolic links"});
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--csv", folder / "other/new"}, {"--json", folder / "again"}});
      },
      {"--json: ", "is also the --csv"});
  const auto write = [](std::ostream& out) { out << "whole"; };
  WriteFileAtomically(folder / "again", write);
  EXPECT_EQ(FileSize(folder / "other/new"), 5u);
  Touch(folder / "photo");
  CloneFile(folder / "photo", folder / "link");
  EXPECT_EQ(FileSize(folder / "other/new"), 1u);
  MoveFile(folder / "photo", folder / "again");
  EXPECT_TRUE(fs::is_symlink(folder / "again") && fs::is_symlink(folder / "link"));
  EXPECT_THAT(FolderEntries(folder / "other"), ElementsAre(folder / "other/new"));
}

TEST(Files, AFolderIsReplacedWhereItsLinkLeads) {
  const TempDir dir;
  fs::create_directories(dir / "disk");
  fs::create_symlink("disk/shape", dir / "shape");
  for (int i = 0; i < 2; ++i) {
    AtomicFolder shape(dir / "shape");
    WriteFile(shape.TemporaryPath() / "a.csv", [](std::ostream& out) { out << "a"; });
    shape.Commit();
    EXPECT_TRUE(fs::is_symlink(dir / "shape"));
    EXPECT_TRUE(fs::is_regular_file(dir / "disk/shape/a.csv"));
    EXPECT_EQ(FolderEntries(dir / "disk").size(), 1u);
  }
}

TEST(Files, LongNamesThatTheSystemTakesCanBeWritten) {
  const TempDir dir;
  const fs::path path = dir / std::string(250, 'n');
  WriteFileAtomically(path, [](std::ostream& out) { out << "a"; });
  EXPECT_EQ(FileSize(path), 1u);
}

TEST(Files, ACurrentFolderThatIsGoneIsAnInputError) {
  const TempDir dir;
  const fs::path before = fs::current_path();
  fs::create_directory(dir / "gone");
  fs::current_path(dir / "gone");
  fs::remove(dir / "gone");
  for (const auto& call : {std::function<void()>([] { AbsolutePath("a.csv"); }),
                           std::function<void()>([] { CanonicalPath("a.csv"); }),
                           std::function<void()>([] { AbsoluteFolder("a.csv"); })}) {
    ExpectThrows<InputError>(call, {"a.csv", "current folder"});
  }
  fs::current_path(before);
}

TEST(TemporaryFolder, OfAnEmptySettingIsThatOfTheSystem) {
  const char* earlier = std::getenv("TMPDIR");
  const std::string restored = earlier == nullptr ? "" : earlier;
  setenv("TMPDIR", "", 1);
  { EXPECT_EQ(TemporaryFolder().path().parent_path(), "/tmp"); }
  setenv("TMPDIR", "/nowhere", 1);
  ExpectThrows<InputError>([] { TemporaryFolder(); }, {"TMPDIR /nowhere", "set TMPDIR"});
  restored.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", restored.c_str(), 1);
}

TEST(Files, ListingsFollowLinksAndLeaveHiddenFilesOut) {
  const TempDir dir;
  fs::create_directories(dir / "photos/.thumbnails");
  fs::create_directories(dir / "elsewhere");
  Touch(dir / "elsewhere/c");
  Touch(dir / "photos/b");
  Touch(dir / "photos/.hidden");
  Touch(dir / "photos/.thumbnails/b");
  fs::create_symlink(dir / "elsewhere", dir / "photos/a");
  fs::create_symlink(dir / "nowhere", dir / "photos/dangling");
  EXPECT_THAT(FilesBelow(dir / "photos"),
              UnorderedElementsAre(dir / "photos/a/c", dir / "photos/b", dir / "photos/dangling"));
  EXPECT_THAT(FolderEntries(dir / "photos"),
              ElementsAre(dir / "photos/.hidden", dir / "photos/.thumbnails", dir / "photos/a",
                          dir / "photos/b", dir / "photos/dangling"));
}

TEST(TemporaryFolder, OfAKilledRunIsRemovedByTheNext) {
  const TempDir dir;
  const char* earlier = std::getenv("TMPDIR");
  const std::string restored = earlier == nullptr ? "" : earlier;
  setenv("TMPDIR", dir.path().c_str(), 1);
  const fs::path killed = dir / ".velamap_scratch_killed", empty = dir / ".velamap_scratch_empty0";
  const fs::path theirs = dir / "velamap_theirs";
  const fs::path workspace = dir / "velamap_result";  // of a run that was killed, too
  for (const fs::path& folder : {killed, empty, theirs, workspace}) fs::create_directory(folder);
  Touch(workspace / ".velamap.lock");
  std::ofstream(killed / "lock").close();
  Touch(killed / "file");
  fs::create_symlink(theirs, dir / ".velamap_scratch_linked");
  {
    const TemporaryFolder one;
    const TemporaryFolder other;
    EXPECT_TRUE(fs::exists(one.path()));
  }
  EXPECT_THAT(FolderEntries(dir.path()),
              ElementsAre(dir / ".velamap_scratch_linked", workspace, theirs));
  restored.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", restored.c_str(), 1);
}

TEST(Files, LinksInCirclesAreFollowedOnce) {
  const TempDir dir;
  fs::create_directories(dir / "photos/day1");
  Touch(dir / "photos/day1/a");
  fs::create_symlink(dir / "photos", dir / "photos/day1/up");
  fs::create_symlink("day1", dir / "photos/again");
  fs::create_symlink("itself", dir / "photos/itself");
  EXPECT_THAT(FilesBelow(dir / "photos"),
              UnorderedElementsAre(dir / "photos/day1/a", dir / "photos/itself"));
}

TEST(Files, AnEditOfACloneLeavesTheOriginal) {
  const TempDir dir;
  Touch(dir / "from");
  fs::create_symlink("from", dir / "link");
  for (const char* from : {"from", "link"}) {
    CloneFile(dir / from, dir / "a/b/to");
    EXPECT_FALSE(IsSameFile(dir / "from", dir / "a/b/to"));
    std::ofstream(dir / "a/b/to") << "edited";
    EXPECT_EQ(ReadTextFile(dir / "from", "original"), "x");
  }
  CloneFile(dir / "from", dir / "a/b/to");
  EXPECT_EQ(ReadTextFile(dir / "a/b/to", "copy"), "x");
  EXPECT_EQ(FolderEntries(dir / "a/b").size(), 1u);
}

// What a full disk looks like without needing one.
[[noreturn]] void CopyOntoAFullDisk(const fs::path& from, const fs::path& to) {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, RLIM_INFINITY}, any{RLIM_INFINITY, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &none);
  try {
    CloneFile(from, to);
  } catch (const InputError& error) {
    setrlimit(RLIMIT_FSIZE, &any);
    std::cerr << error.what();
    std::_Exit(2);
  }
  std::_Exit(0);
}

TEST(Files, ACopyThatFailsNamesTheFileAndTheReason) {
  const TempDir dir;
  Touch(dir / "from");
  ExpectThrows<InputError>([&] { CloneFile(dir / "none", dir / "to"); },
                           {dir / "none", "cannot be read", "No such file"});
  fs::create_directories(dir / "to/full");
  ExpectThrows<InputError>([&] { CloneFile(dir / "from", dir / "to"); },
                           {dir / "to", "cannot be written", "directory"});
  EXPECT_EXIT(CopyOntoAFullDisk(dir / "from", dir / "copy"), testing::ExitedWithCode(2),
              "copy: cannot be written: File too large");
  EXPECT_FALSE(fs::exists(dir / "copy"));
  EXPECT_EQ(FolderEntries(dir.path()).size(), 2u);
}

}  // namespace
}  // namespace velamap
