#include "importer/video/source_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

class SourceFileTest : public ::testing::Test {
 protected:
  // A file of 3 MB with a byte of its own at this place.
  std::string Write(const std::string& name, std::streamoff place, char byte) const {
    std::string bytes(3 << 20, 'a');
    bytes[static_cast<std::size_t>(place)] = byte;
    std::ofstream(dir_ / name, std::ios::binary) << bytes;
    return (dir_ / name).string();
  }

  TempDir dir_;
};

TEST_F(SourceFileTest, EveryByteOfAPictureCounts) {
  const SourceFile known = IdentifySource(Write("a.tif", 0, 'a'));
  const fs::file_time_type time = fs::last_write_time(dir_ / "a.tif");
  for (const std::streamoff place : {1, 100'000, 1'234'567, (3 << 20) - 1}) {
    const std::string path = Write("a.tif", place, 'b');
    fs::last_write_time(path, time);  // as some programs do
    EXPECT_FALSE(HasSameContent(known, path)) << place;
  }
  EXPECT_TRUE(HasSameContent(known, Write("a.tif", 0, 'a')));
}

TEST_F(SourceFileTest, NamesAndTimesDoNotCount) {
  for (const std::string name : {"a.tif", "a.mp4"}) {
    const std::string path = Write(name, 7, 'b');
    const SourceFile known = IdentifySource(path);
    EXPECT_TRUE(HasSameContent(known, path));
    fs::last_write_time(path, fs::file_time_type::clock::now());
    EXPECT_TRUE(HasSameContent(known, path));
    EXPECT_TRUE(HasSameContent(known, Write("moved_" + name, 7, 'b')));
    fs::resize_file(path, (3 << 20) + 1);
    EXPECT_FALSE(HasSameContent(known, path));
  }
}

TEST_F(SourceFileTest, BeginAndEndOfAVideoCount) {
  const SourceFile known = IdentifySource(Write("a.mp4", 0, 'a'));
  for (const std::streamoff place : {0, (3 << 20) - 1}) {
    EXPECT_FALSE(HasSameContent(known, Write("a.mp4", place, 'b'))) << place;
  }
}

TEST_F(SourceFileTest, IsNotReadAgainUntouchedInItsPlace) {
  const std::string path = Write("a.tif", 0, 'a');
  SourceFile known = IdentifySource(path);
  known.content_hash += 1;
  EXPECT_TRUE(HasSameContent(known, path));
  EXPECT_FALSE(HasSameContent(known, Write("b.tif", 0, 'a')));
  // Copies of photographs of one size may have the same times.
  known.path_hash += 1;
  EXPECT_FALSE(HasSameContent(known, path));
}

TEST_F(SourceFileTest, PlaceIsKnownWithoutTheNamesOfFolders) {
  fs::create_directory(dir_ / "other");
  const std::string path = Write("a.tif", 0, 'a'), other = Write("other/a.tif", 0, 'a');
  const SourceFile known = IdentifySource(path);
  EXPECT_EQ(known.name, "a.tif");
  EXPECT_EQ(SourceText(known).rfind("a.tif, 3145728 bytes of ", 0), 0u) << SourceText(known);
  EXPECT_TRUE(IsSamePlace(known, dir_ / "other/../a.tif"));
  EXPECT_FALSE(IsSamePlace(known, other));
  fs::remove(path);
  EXPECT_TRUE(IsSamePlace(known, path));
}

TEST_F(SourceFileTest, NamesAFileThatIsNotThere) {
  ExpectThrows<InputError>([&] { IdentifySource((dir_ / "none.png").string()); }, {"none.png"});
}

}  // namespace
}  // namespace velamap
