#include "importer/base/stage_timer.h"

#include <ctime>
#include <utility>

namespace velamap {
namespace {

constexpr int kNoStage = -1;

double Seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

BusyTime Now() { return {Seconds(CLOCK_MONOTONIC), Seconds(CLOCK_THREAD_CPUTIME_ID)}; }

struct ThreadClock {
  int stage = kNoStage;  // the stage to which time is charged now
  BusyTime since;
  ImportTimes times;
};

ThreadClock& ClockOfThread() {
  thread_local ThreadClock clock;
  return clock;
}

// Charges the time that has passed, continues with `stage` and returns the previous stage.
int SwitchTo(int stage) {
  ThreadClock& clock = ClockOfThread();
  const BusyTime now = Now();
  if (clock.stage != kNoStage) {
    BusyTime& time = clock.times[static_cast<ImportStage>(clock.stage)];
    time.wall_s += now.wall_s - clock.since.wall_s;
    time.cpu_s += now.cpu_s - clock.since.cpu_s;
  }
  clock.since = now;
  return std::exchange(clock.stage, stage);
}

}  // namespace

const char* ImportStageName(ImportStage stage) {
  constexpr std::array<const char*, kNumImportStages> kNames = {"formation", "decode", "detect",
                                                                "refine",    "images", "database"};
  return kNames[static_cast<std::size_t>(stage)];
}

ImportTimes& ImportTimes::operator+=(const ImportTimes& other) {
  for (std::size_t i = 0; i < kNumImportStages; ++i) {
    times_[i].wall_s += other.times_[i].wall_s;
    times_[i].cpu_s += other.times_[i].cpu_s;
  }
  return *this;
}

double ImportTimes::CpuSeconds() const {
  double sum = 0.0;
  for (const BusyTime& time : times_) sum += time.cpu_s;
  return sum;
}

StageTimer::StageTimer(ImportStage stage) : outer_(SwitchTo(static_cast<int>(stage))) {}

StageTimer::~StageTimer() { SwitchTo(outer_); }

ImportTimes TakeStageTimes() {
  SwitchTo(ClockOfThread().stage);
  return std::exchange(ClockOfThread().times, {});
}

double ProcessCpuSeconds() { return Seconds(CLOCK_PROCESS_CPUTIME_ID); }

ProcessTimer::ProcessTimer() : begin_{Seconds(CLOCK_MONOTONIC), ProcessCpuSeconds()} {}

BusyTime ProcessTimer::Elapsed() const {
  return {Seconds(CLOCK_MONOTONIC) - begin_.wall_s, ProcessCpuSeconds() - begin_.cpu_s};
}

}  // namespace velamap
