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
    const SourceFile known = IdentifySource(Write(name, 7, 'b'));
    EXPECT_TRUE(HasSameContent(known, known.path));
    fs::last_write_time(known.path, fs::file_time_type::clock::now());
    EXPECT_TRUE(HasSameContent(known, known.path));
    EXPECT_TRUE(HasSameContent(known, Write("moved_" + name, 7, 'b')));
    fs::resize_file(known.path, (3 << 20) + 1);
    EXPECT_FALSE(HasSameContent(known, known.path));
  }
}

TEST_F(SourceFileTest, BeginAndEndOfAVideoCount) {
  const SourceFile known = IdentifySource(Write("a.mp4", 0, 'a'));
  for (const std::streamoff place : {0, (3 << 20) - 1}) {
    EXPECT_FALSE(HasSameContent(known, Write("a.mp4", place, 'b'))) << place;
  }
}

TEST_F(SourceFileTest, NamesAFileThatIsNotThere) {
  ExpectThrows<InputError>([&] { IdentifySource((dir_ / "none.png").string()); }, {"none.png"});
}

}  // namespace
}  // namespace velamap
