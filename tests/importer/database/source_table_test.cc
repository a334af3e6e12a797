#include "importer/database/source_table.h"

#include <fstream>
#include <iterator>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "importer/base/files.h"
#include "importer/database/colmap_database.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using Mode = ColmapDatabase::Mode;

class SourceTable : public ::testing::Test {
 protected:
  // A photograph in the folder, as it is found there.
  SourceFile Photograph(const std::string& name) const {
    std::ofstream(dir_ / name) << "photograph " << name;
    return IdentifySource((dir_ / name).string());
  }

  // The table that velamap 0.1 wrote.
  void WriteEarlierTable(const SourceFile& source) const {
    ColmapDatabase(path_, Mode::kReadWriteCreate);
    SQLite::Database(path_, SQLite::OPEN_READWRITE)
        .exec(fmt::format(
            "CREATE TABLE marker_sources (image_name TEXT PRIMARY KEY NOT NULL, path TEXT NOT NULL,"
            " size INTEGER NOT NULL, modified_s INTEGER NOT NULL, changed_ns INTEGER NOT NULL,"
            " content_hash INTEGER NOT NULL);"
            "INSERT INTO marker_sources VALUES('1.png', '{}', {}, {}, {}, {})",
            CanonicalPath(dir_ / source.name).string(), source.size, source.modified_s,
            source.changed_ns, static_cast<std::int64_t>(source.content_hash)));
  }

  TempDir dir_;
  std::string path_ = dir_ / "database.db";
};

void ExpectSame(const SourceFile& a, const SourceFile& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.path_hash, b.path_hash);
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.modified_s, b.modified_s);
  EXPECT_EQ(a.changed_ns, b.changed_ns);
  EXPECT_EQ(a.content_hash, b.content_hash);
}

TEST_F(SourceTable, HoldsNoNameOfAFolder) {
  const SourceFile photograph = Photograph("1.png");
  {
    ColmapDatabase database(path_, Mode::kReadWriteCreate);
    database.WriteSource("1.png", photograph);
    ExpectSame(database.ReadSources().at("1.png"), photograph);
  }
  std::ifstream stream(path_, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_EQ(bytes.find(CanonicalPath(dir_.path()).string()), std::string::npos);
}

TEST_F(SourceTable, OfAnEarlierVersionIsRead) {
  const SourceFile photograph = Photograph("1.png");
  WriteEarlierTable(photograph);
  ExpectSame(ColmapDatabase(path_, Mode::kReadOnly).ReadSources().at("1.png"), photograph);
}

TEST_F(SourceTable, OfAnEarlierVersionIsBroughtUpToDate) {
  const SourceFile first = Photograph("1.png"), second = Photograph("2.png");
  WriteEarlierTable(first);
  ColmapDatabase database(path_, Mode::kReadWriteCreate);
  database.WriteSource("2.png", second);
  ExpectSame(database.ReadSources().at("1.png"), first);
  ExpectSame(database.ReadSources().at("2.png"), second);
  EXPECT_EQ(SQLite::Database(path_)
                .execAndGet("SELECT path FROM marker_sources WHERE image_name = '1.png'")
                .getString(),
            "1.png");
}

}  // namespace
}  // namespace velamap
