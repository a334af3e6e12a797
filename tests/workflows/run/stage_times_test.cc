#include "workflows/run/stage_times.h"

#include <chrono>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::MatchesRegex;

TEST(StageTimes, SleepTakesWallTimeAndWorkTakesCpuTime) {
  StageClock clock;
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  clock.End("sleep");
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(60);
  while (std::chrono::steady_clock::now() < end) {
  }
  clock.End("work", 6);
  const std::vector<StageTime> times = clock.Times();
  ASSERT_EQ(times.size(), 3u);
  EXPECT_GE(times[0].wall_s, 0.06);
  EXPECT_LT(times[0].cpu_s, 0.03);
  EXPECT_GE(times[1].wall_s, 0.06);
  EXPECT_GT(times[1].cpu_s, 0.005);  // of a machine that others use too
  EXPECT_EQ(times[2].name, "total");
  EXPECT_NEAR(times[2].wall_s, times[0].wall_s + times[1].wall_s, 1e-9);
  EXPECT_NEAR(times[2].cpu_s, times[0].cpu_s + times[1].cpu_s, 1e-9);
  EXPECT_GT(times[2].peak_memory_mb, 1.0);
}

TEST(StageTimes, PartsOfTheImportAddNothingToTheTotal) {
  ImportTimes parts;
  parts[ImportStage::kDecode] = {30.0, 40.0};
  parts[ImportStage::kDatabase] = {1.0, 2.0};
  StageClock clock;
  clock.EndImport(parts, 10);
  const std::vector<StageTime> times = clock.Times();
  ASSERT_EQ(times.size(), 4u);  // stages in which nothing was done are not there
  EXPECT_EQ(times[0].name, "import");
  EXPECT_EQ(times[1].name, "decode");
  EXPECT_EQ(times[1].part_of, "import");
  EXPECT_EQ(times[1].cpu_s, 40.0);
  EXPECT_EQ(times[2].name, "database");
  EXPECT_EQ(times[2].num_frames, 10);
  EXPECT_LT(times[3].cpu_s, 1.0);
}

// It looks at a few frames before the others, so it has no rate.
TEST(StageTimes, FormationIsTheFirstPartOfTheImport) {
  ImportTimes parts;
  parts[ImportStage::kFormation] = {6.0, 12.0};
  parts[ImportStage::kDetect] = {0.1, 0.2};
  StageClock clock;
  clock.EndImport(parts, 6);
  const std::vector<StageTime> times = clock.Times();
  ASSERT_EQ(times.size(), 4u);
  EXPECT_EQ(times[1].name, "formation");
  EXPECT_EQ(times[1].part_of, "import");
  EXPECT_EQ(times[1].num_frames, 0);
  EXPECT_EQ(times[2].num_frames, 6);
  EXPECT_THAT(StageTable(times)[2], MatchesRegex("  formation +6.00 +12.00 +[0-9]+"));
}

// As of an import that finds all pictures in the database.
TEST(StageTimes, BelowAMillisecondThereIsNoRate) {
  const std::vector<StageTime> times = {{"import", "", 4e-4, 3e-4, 100, 250.0},
                                        {"decode", "import", 2.0, 9e-4, 100, 250.0},
                                        {"export", "", 2e-3, 0.0, 100, 250.0}};
  const std::vector<std::string> table = StageTable(times);
  EXPECT_THAT(table[1], MatchesRegex("import +0.00 +0.00 +250"));
  EXPECT_THAT(table[2], MatchesRegex("  decode +2.00 +0.00 +250"));
  EXPECT_THAT(table[3], MatchesRegex("export +0.00 +0.00 +50000.0 +250"));
  std::ostringstream out;
  WriteStageTimesJson(times, out);
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json[0].at("num_frames"), 100);
  EXPECT_FALSE(json[0].contains("frames_per_s"));
  EXPECT_FALSE(json[1].contains("frames_per_cpu_s"));
}

TEST(StageTimes, TableAndJsonSayTheSame) {
  const std::vector<StageTime> times = {{"import", "", 2.0, 3.5, 100, 250.0},
                                        {"decode", "import", 1.0, 2.0, 100, 250.0},
                                        {"export", "", 1.0, 1.0, 0, 300.0}};
  EXPECT_THAT(StageTable(times), ElementsAre(MatchesRegex("stage +wall s +CPU s +frames/s +MB"),
                                             MatchesRegex("import +2.00 +3.50 +50.0 +250"),
                                             MatchesRegex("  decode +1.00 +2.00 +50.0 +250"),
                                             MatchesRegex("export +1.00 +1.00 +300")));
  std::ostringstream out;
  WriteStageTimesJson(times, out);
  const auto json = nlohmann::json::parse(out.str());
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0].at("frames_per_s"), 50.0);
  EXPECT_FALSE(json[0].contains("part_of"));
  EXPECT_EQ(json[1].at("part_of"), "import");
  EXPECT_EQ(json[1].at("frames_per_cpu_s"), 50.0);
  EXPECT_EQ(json[2].at("stage"), "export");
  EXPECT_FALSE(json[2].contains("frames_per_s"));
}

}  // namespace
}  // namespace velamap
