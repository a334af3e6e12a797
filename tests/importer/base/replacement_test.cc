#include "importer/base/replacement.h"

#include <ctime>
#include <fstream>

#include <gmock/gmock.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/file_lock.h"
#include "importer/base/files.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

void Write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

void WriteFolder(const fs::path& path) {
  AtomicFolder folder(path);
  Write(folder.TemporaryPath() / "cameras.bin", "ours");
  folder.Commit();
}

TEST(ReplaceableFolder, IsOneWhoseFilesAreAllOurs) {
  const TempDir dir;
  CheckReplaceableFolder(dir / "none");
  CheckReplaceableFolder(dir.path());  // empty
  fs::create_directories(dir / "sparse/empty");
  WriteFolder(dir / "sparse/0");
  WriteFolder(dir / "sparse/0");
  CheckReplaceableFolder(dir / "sparse");
  Write(dir / "sparse/.0.tmp-17-0", "left by an interrupted run");
  CheckReplaceableFolder(dir / "sparse");
}

TEST(ReplaceableFolder, IsNoneWithAForeignOrChangedFile) {
  const TempDir dir;
  const auto expect_refused = [&](const std::string& name, const std::string& why) {
    ExpectThrows<InputError>([&] { CheckReplaceableFolder(dir / "sparse"); }, {name, why});
    ExpectThrows<InputError>([&] { AtomicFolder folder(dir / "sparse"); }, {name, why});
  };
  WriteFolder(dir / "sparse/0");
  // Another program writes files of the same names.
  Write(dir / "sparse/0/cameras.bin", "theirs");
  expect_refused("cameras.bin", "was changed");
  fs::remove(dir / "sparse/0/cameras.bin");
  Write(dir / "elsewhere", "ours");
  fs::create_symlink(dir / "elsewhere", dir / "sparse/0/cameras.bin");
  expect_refused("cameras.bin", "did not write");
  WriteFolder(dir / "sparse/1");
  fs::remove_all(dir / "sparse/0");
  for (const char* name : {"sparse/notes.txt", "sparse/1/cameras.txt", "sparse/1/.hidden"}) {
    Write(dir / name, "notes");
    expect_refused(fs::path(name).filename(), "did not write");
    fs::remove(dir / name);
  }
  CheckReplaceableFolder(dir / "sparse");
}

TEST(ReplaceableFolder, IsLookedAtAgainBeforeItIsReplaced) {
  const TempDir dir;
  WriteFolder(dir / "sparse");
  AtomicFolder folder(dir / "sparse");
  Write(dir / "sparse/notes.txt", "written during the run");
  ExpectThrows<InputError>([&] { folder.Commit(); }, {"notes.txt"});
  EXPECT_TRUE(fs::exists(dir / "sparse/notes.txt"));
}

TEST(Outputs, AreNoInputsUnderAnyName) {
  const TempDir dir;
  Write(dir / "a", "input");
  fs::create_symlink("a", dir / "link");
  fs::create_symlink(dir.path(), dir / "folder");
  fs::create_hard_link(dir / "a", dir / "hard");
  for (const fs::path& output :
       {dir / "a", dir / "link", dir / "hard", dir / "folder/a", dir / "none/../a"}) {
    ExpectThrows<InputError>(
        [&] {
          CheckOutputs({{"--in", dir / "a"}}, {{"--out", output}});
        },
        {"--out: " + output.string(), "is the --in too"});
  }
  CheckOutputs({{"--in", dir / "a"}}, {{"--out", dir / "b"}});
  // Not there yet, but the same.
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--csv", dir / "b"}, {"--json", dir / "folder/b"}});
      },
      {"--json: ", "is the --csv too"});
}

TEST(Outputs, FoldersThatAreReplacedHoldNoInputsAndNoOtherOutputs) {
  const TempDir dir;
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({{"--in", dir / "sparse/0"}}, {{"--out", dir / "sparse", true}});
      },
      {"--out: ", "replaced as a whole", "--in"});
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--out", dir / "out", true}, {"--log", dir / "out/a.log"}});
      },
      {"--out: ", "--log"});
  CheckOutputs({{"--in", dir / "sparse/seed"}},
               {{"--out", dir / "sparse/0", true}, {"--log", dir / "sparse/a.log"}});
  fs::create_directory(dir / "home");
  Write(dir / "home/thesis.tex", "text");
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--out", dir / "home", true}});
      },
      {"thesis.tex"});
}

TEST(ImageNames, MustNotLeadOut) {
  for (const char* name : {"a.jpg", "day1/a.jpg", "..a.jpg", "day1/..b/a.jpg", "./a.jpg"}) {
    CheckImageName(name, "database.db");
  }
  for (const std::string& name :
       {std::string("../a.jpg"), std::string("/a.jpg"), std::string("day1/../../a.jpg"),
        std::string(".."), std::string(), std::string("a\0.jpg", 6)}) {
    ExpectThrows<InputError>([&] { CheckImageName(name, "database.db"); },
                             {"database.db", "leads out"});
  }
}

TEST(FileLock, TheHolderIsDescribedByTimeProcessAndPlace) {
  std::tm noon{};
  noon.tm_year = 2026 - 1900;
  noon.tm_mon = 10;
  noon.tm_mday = 22;
  noon.tm_hour = 14;
  noon.tm_min = 2;
  noon.tm_isdst = -1;
  const std::time_t since = std::mktime(&noon);
  const std::string record = std::to_string(since) + " 4711 sailboat\n";
  EXPECT_EQ(DescribeLockHolder(record, since + 600, "sailboat"), "since 14:02, process 4711");
  EXPECT_EQ(DescribeLockHolder(record, since + 86400, "sailboat"),
            "since 2026-11-22 14:02, process 4711");
  EXPECT_EQ(DescribeLockHolder(record, since, "dinghy"), "since 14:02, process 4711 on sailboat");
  EXPECT_EQ(DescribeLockHolder("", since, "dinghy"), "");
  EXPECT_EQ(DescribeLockHolder("someone", since, "dinghy"), "");
}

TEST(FileLock, IsHeldByOneAtATimeAndLeavesNothing) {
  const TempDir dir;
  {
    const FileLock lock(dir / ".lock", "database.db");
    ExpectThrows<InputError>([&] { FileLock other(dir / ".lock", "database.db"); },
                             {"database.db: another velamap works here since ", "process "});
  }
  { const FileLock lock(dir / ".lock", "database.db"); }
  EXPECT_TRUE(fs::is_empty(dir.path()));
  const FileLock nowhere(dir / "none/.lock", "database.db");  // its writers will say why
}

}  // namespace
}  // namespace velamap
