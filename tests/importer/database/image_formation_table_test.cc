#include "importer/database/image_formation_table.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/database/colmap_database.h"
#include "importer/formation/formation_problem.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using Mode = ColmapDatabase::Mode;

TEST(ImageFormationTable, HoldsOneRow) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  FormationEstimate estimate;
  estimate.parameters = {1.9, 0.02, 0.4, 1.2, -0.001, -0.2, 0.1, true, 0.7, 0.15, 0.3, 0.08, 3.5};
  estimate.num_samples = 31;
  estimate.noise_gray = 2.5;
  estimate.inset_sigma_px = 0.012;
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    EXPECT_FALSE(database.ReadFormation());
    database.WriteFormation({});
    database.WriteFormation(estimate);
  }
  const auto read = ColmapDatabase(path, Mode::kReadOnly).ReadFormation();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->parameters.gamma, 1.9);
  EXPECT_EQ(read->parameters.s_amplitude, 0.02);
  EXPECT_EQ(read->parameters.sharpening, 0.4);
  EXPECT_EQ(read->parameters.sharpening_radius_px, 1.2);
  EXPECT_EQ(read->parameters.ink_spread_mm, -0.001);
  EXPECT_EQ(read->parameters.edge_shift_blurs, -0.2);
  EXPECT_EQ(read->parameters.outline_shift_blurs, 0.1);
  EXPECT_EQ(read->parameters.outline_corner_weight, 0.3);
  EXPECT_EQ(read->parameters.halo, 0.08);
  EXPECT_EQ(read->parameters.halo_radius_px, 3.5);
  EXPECT_TRUE(read->parameters.is_inverted);
  EXPECT_EQ(read->parameters.quiet_zone_cells, 0.7);
  EXPECT_EQ(read->parameters.quiet_zone_sigma_cells, 0.15);
  EXPECT_EQ(read->num_samples, 31);
  EXPECT_EQ(read->noise_gray, 2.5);
  EXPECT_EQ(read->inset_sigma_px, 0.012);
}

// Ink reaches a third of a millimetre, which is much of the side of a tiny marker.
TEST(ImageFormationTable, HoldsTheMostInkThatAnEstimateOfTinyMarkersGives) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  FormationSample sample;
  sample.marker.side_mm = 1.0;
  FormationEstimate estimate;
  double& ink_spread = estimate.parameters.ink_spread_mm;
  ink_spread = PriorsFor({sample}).max[kInkSpread];
  EXPECT_GT(ink_spread, 0.0);
  ColmapDatabase(path, Mode::kReadWriteCreate).WriteFormation(estimate);
  const auto read = ColmapDatabase(path, Mode::kReadOnly).ReadFormation();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->parameters.ink_spread_mm, ink_spread);
}

// The corners of outlines had no weight of their own, edges no shift but that of the ink, which was
// a share of the side, and lenses no halo.
TEST(ImageFormationTable, OfAnEarlierVersionIsReadAndReplaced) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  ColmapDatabase(path, Mode::kReadWriteCreate).WriteFormation({});
  {
    SQLite::Database database(path, SQLite::OPEN_READWRITE);
    database.exec("ALTER TABLE image_formation DROP COLUMN outline_corner_weight");
    database.exec("ALTER TABLE image_formation DROP COLUMN edge_shift_blurs");
    database.exec("ALTER TABLE image_formation DROP COLUMN outline_shift_blurs");
    database.exec("ALTER TABLE image_formation DROP COLUMN halo");
    database.exec("ALTER TABLE image_formation DROP COLUMN halo_radius_px");
    database.exec("ALTER TABLE image_formation RENAME COLUMN ink_spread_mm TO ink_spread_sides");
    database.exec("UPDATE image_formation SET ink_spread_sides = 0.001");
  }
  const auto read = ColmapDatabase(path, Mode::kReadOnly).ReadFormation();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->parameters.outline_corner_weight, 1.0);
  EXPECT_EQ(read->parameters.edge_shift_blurs, 0.0);
  EXPECT_EQ(read->parameters.outline_shift_blurs, 0.0);
  EXPECT_EQ(read->parameters.halo, 0.0);
  EXPECT_NEAR(read->parameters.ink_spread_mm, 0.1, 1e-12);
  EXPECT_NO_THROW(ColmapDatabase(path, Mode::kReadWriteCreate).WriteFormation({}));
}

}  // namespace
}  // namespace velamap
