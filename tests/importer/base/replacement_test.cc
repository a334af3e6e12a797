#include "importer/base/replacement.h"

#include <sys/wait.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <functional>

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
  Write(TemporarySibling(dir / "sparse/0"), "not finished");
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

TEST(ReplaceableFolder, MayHoldTablesAndLogsOfStepCommands) {
  const TempDir dir;
  WriteFolder(dir / "sparse/0");
  Write(dir / "sparse/registration.csv", "image_name,registered,num_markers,num_outliers\n");
  Write(dir / "sparse/colmap.log", "$ colmap bundle_adjuster --input_path in\n");
  CheckReplaceableFolder(dir / "sparse");
  Write(dir / "sparse/registration.csv", "name,email\n");
  ExpectThrows<InputError>([&] { CheckReplaceableFolder(dir / "sparse"); }, {"registration.csv"});
}

TEST(OwnFile, IsToldByItsBeginningAndSeal) {
  const TempDir dir;
  const fs::path file = dir / "file";
  const auto check = [&] { CheckOwnFile("--report_path", file); };
  EXPECT_NO_THROW(check());  // missing
  for (const std::string ours : {"", "image_name,registered,num_markers,x\na,1,2,3\n",
                                 "[\n {\n  \"stage\": \"import\"\n }]\n",
                                 "%YAML:1.0\n---\n# found by velamap 0.2.0\nimage_width: 3\n",
                                 "%YAML:1.0\n---\n# velamap camera_calibrator: RADIAL\n",
                                 "<!DOCTYPE html>\n<title>boat – velamap report</title>\n"}) {
    Write(file, ours);
    EXPECT_NO_THROW(check()) << ours;
  }
  for (const std::string theirs : {"name,email\n", "{}", "%YAML:1.0\n---\nimage_width: 3\n",
                                   "<!DOCTYPE html>\n<title>Holidays</title>\n<p>with velamap\n"}) {
    Write(file, theirs);
    ExpectThrows<InputError>(check, {"--report_path: ", file.string(), "did not write it"});
  }
  const std::string page = "<!DOCTYPE html>\n<title>velamap</title>\n<p>text";
  const std::string sealed = WithSeal(page, "<!-- ", " -->");
  Write(file, sealed);
  EXPECT_NO_THROW(check());
  std::string edited = sealed;
  edited.replace(edited.find("text"), 4, "note");
  for (const std::string& changed : {edited, sealed + "note\n", "<!DOCTYPE html>\n" + sealed}) {
    Write(file, changed);
    ExpectThrows<InputError>(check, {"was changed after velamap wrote it"});
  }
}

TEST(OwnFile, IsAProposedLayoutOnlyWithItsSeal) {
  const TempDir dir;
  const fs::path file = dir / "layout.yml";
  const auto check = [&] { CheckOwnFile("--proposed_layout_path", file); };
  const std::string text = "# Proposed by velamap clip_checker.\nmarker_length: 0.1\n";
  Write(file, WithSeal(text, "# ", ""));
  EXPECT_NO_THROW(check());
  std::string edited = WithSeal(text, "# ", "");
  edited.replace(edited.find("0.1"), 3, "0.2");
  for (const std::string& changed : {text, edited}) {
    Write(file, changed);
    ExpectThrows<InputError>(check, {"was changed after velamap wrote it", "move it away"});
  }
}

// Whoever runs the test: the administrator may write everything.
TEST(ReplaceableFolder, IsNoneThatIsWriteProtected) {
  const TempDir dir;
  WriteFolder(dir / "sparse");
  fs::permissions(dir / "sparse", fs::perms::owner_read | fs::perms::owner_exec);
  for (const auto& write : {std::function<void()>([&] { CheckReplaceableFolder(dir / "sparse"); }),
                            std::function<void()>([&] { WriteFolder(dir / "sparse"); })}) {
    ExpectThrows<InputError>(write, {dir / "sparse", "write-protected"});
  }
  fs::permissions(dir / "sparse", fs::perms::owner_all);
  WriteFolder(dir / "sparse");
  Write(dir / "table.csv", "kept");
  fs::permissions(dir / "table.csv", fs::perms::owner_read);
  ExpectThrows<InputError>([&] { WriteFileAtomically(dir / "table.csv", [](std::ostream&) {}); },
                           {dir / "table.csv", "write-protected"});
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--csv_path", dir / "table.csv"}});
      },
      {dir / "table.csv", "write-protected"});
}

TEST(UnfinishedOutput, OfAKilledProcessIsRemovedAndNoOther) {
  const TempDir dir;
  const fs::path own = TemporarySibling(dir / "own");
  Write(own, "of a run that goes on");
  for (const char* name : {".notes.tmp-2024-05", ".notes.velamap-tmp-2024-05", ".velamap-tmp-1-1",
                           ".a.velamap-tmp-0123456789abcdef-17-0"}) {
    Write(dir / name, "of the user, or of another machine");
  }
  const pid_t killed = fork();
  if (killed == 0) {
    fs::create_directories(TemporarySibling(dir / "sparse") / "seed");
    const fs::path database = TemporarySibling(dir / "merged.db");
    Write(database, "left");
    Write(database.string() + "-journal", "left");
    _exit(0);
  }
  waitpid(killed, nullptr, 0);
  EXPECT_EQ(FolderEntries(dir.path()).size(), 8u);
  RemoveUnfinished(dir.path());
  EXPECT_EQ(FolderEntries(dir.path()).size(), 5u);
  EXPECT_TRUE(fs::exists(own));
  EXPECT_EQ(FinalPath(own / "a.csv"), dir / "own/a.csv");
  EXPECT_EQ(FinalPath(".notes.velamap-tmp-2024-05"), ".notes.velamap-tmp-2024-05");
}

TEST(UnfinishedOutput, IsRemovedWhereTheNextOneIsWritten) {
  const TempDir dir;
  fs::create_directory(dir / "out");
  const pid_t killed = fork();
  if (killed == 0) {
    Write(TemporarySibling(dir / "out/a.csv"), "left");
    _exit(0);
  }
  waitpid(killed, nullptr, 0);
  WriteFileAtomically(dir / "out/b.csv", [](std::ostream& out) { out << "whole"; });
  EXPECT_EQ(FolderEntries(dir / "out").size(), 1u);
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
        {"--out: " + output.string(), "is also the --in"});
  }
  CheckOutputs({{"--in", dir / "a"}}, {{"--out", dir / "b"}});
  // Not there yet, but the same.
  ExpectThrows<InputError>(
      [&] {
        CheckOutputs({}, {{"--csv", dir / "b"}, {"--json", dir / "folder/b"}});
      },
      {"--json: ", "is also the --csv"});
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

TEST(ImageNames, HoldNoLineBreaks) {
  for (const char* name : {"a\nb.jpg", "a.jpg\r"}) {
    ExpectThrows<InputError>([&] { CheckImageName(name, "photos"); }, {"photos", "line break"});
  }
}

TEST(FileLock, LeavesAFileOfTheUser) {
  const TempDir dir;
  const std::string text = "42 notes\nof mine";
  for (const std::string& notes :
       {text, std::string("1700000000 4711 host\n") + std::string(300, 'x')}) {
    Write(dir / ".lock", notes);
    ExpectThrows<InputError>([&] { FileLock lock(dir / ".lock", "database.db"); },
                             {dir / ".lock", "did not write"});
    EXPECT_EQ(fs::file_size(dir / ".lock"), notes.size());
  }
  for (const char* left : {"", "1700000000 4711 host\n"}) {  // by a run that was killed
    Write(dir / ".lock", left);
    { const FileLock lock(dir / ".lock", "database.db"); }
    EXPECT_FALSE(fs::exists(dir / ".lock"));
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
    ExpectThrows<InputError>(
        [&] { FileLock other(dir / ".lock", "database.db"); },
        {"database.db: another velamap process is using it (since ", "process "});
  }
  { const FileLock lock(dir / ".lock", "database.db"); }
  EXPECT_TRUE(fs::is_empty(dir.path()));
  const FileLock nowhere(dir / "none/.lock", "database.db");  // its writers will say why
}

}  // namespace
}  // namespace velamap
