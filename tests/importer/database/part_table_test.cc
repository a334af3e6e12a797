#include "importer/database/part_table.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using Mode = ColmapDatabase::Mode;

const PartRecord kExample = {{2, 5}, {10, 400, 3}, "search=tracked", true};

TEST(PartTable, GivesBackWhatWasWritten) {
  const TempDir dir;
  ColmapDatabase database(dir / "database.db", Mode::kReadWriteCreate);
  EXPECT_FALSE(database.ReadPart());
  database.WritePart({});
  database.WritePart(kExample);
  const auto read = database.ReadPart();
  ASSERT_TRUE(read);
  EXPECT_EQ(PartText(read->part), "2/5");
  EXPECT_TRUE(read->whole == kExample.whole);
  EXPECT_EQ(read->detector, "search=tracked");
  EXPECT_TRUE(read->is_finished);
  database.ForgetSources();
  EXPECT_FALSE(database.ReadPart());
}

TEST(PartTable, ValuesThatNoImportWritesAreRefused) {
  for (const char* change : {"part = 0", "part = 6", "num_parts = 1e9", "first_frame = -1",
                             "last_frame = 'text'", "frame_step = 0", "is_finished = 2"}) {
    SCOPED_TRACE(change);
    const TempDir dir;
    const std::string path = dir / "database.db";
    ColmapDatabase(path, Mode::kReadWriteCreate).WritePart(kExample);
    SQLite::Database(path, SQLite::OPEN_READWRITE)
        .exec(std::string("UPDATE marker_part SET ") + change);
    const ColmapDatabase database(path, Mode::kReadOnly);
    ExpectThrows<InputError>([&] { database.ReadPart(); }, {path, "table marker_part"});
  }
}

}  // namespace
}  // namespace velamap
