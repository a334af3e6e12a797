#include "importer/base/stage_timer.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr std::chrono::milliseconds kWhile(20);

void Work() {
  const double begin_s = ProcessCpuSeconds();
  while (ProcessCpuSeconds() < begin_s + 0.02) {
  }
}

TEST(StageTimer, InnerStageStopsTheOuterOne) {
  TakeStageTimes();
  {
    const StageTimer detect(ImportStage::kDetect);
    Work();
    {
      const StageTimer refine(ImportStage::kRefine);
      std::this_thread::sleep_for(kWhile);
    }
    Work();
  }
  std::this_thread::sleep_for(kWhile);  // charged to nothing
  const ImportTimes times = TakeStageTimes();
  EXPECT_GE(times[ImportStage::kRefine].wall_s, 0.02);
  EXPECT_LT(times[ImportStage::kRefine].cpu_s, 0.01);
  EXPECT_GE(times[ImportStage::kDetect].cpu_s, 0.03);
  EXPECT_EQ(times[ImportStage::kDecode].wall_s, 0.0);
  EXPECT_DOUBLE_EQ(times.CpuSeconds(),
                   times[ImportStage::kDetect].cpu_s + times[ImportStage::kRefine].cpu_s);
  EXPECT_EQ(TakeStageTimes().CpuSeconds(), 0.0);
}

TEST(StageTimer, ThreadsAreApart) {
  TakeStageTimes();
  ImportTimes of_thread;
  std::thread thread([&of_thread] {
    const StageTimer timer(ImportStage::kDatabase);
    std::this_thread::sleep_for(kWhile);
    of_thread = TakeStageTimes();  // includes the time so far of the running timer
  });
  thread.join();
  EXPECT_GE(of_thread[ImportStage::kDatabase].wall_s, 0.02);
  ImportTimes sum = TakeStageTimes();
  EXPECT_EQ(sum[ImportStage::kDatabase].wall_s, 0.0);
  sum += of_thread;
  sum += of_thread;
  EXPECT_DOUBLE_EQ(sum[ImportStage::kDatabase].wall_s,
                   2 * of_thread[ImportStage::kDatabase].wall_s);
}

}  // namespace
}  // namespace velamap
