// Where the time of an import goes. Its stages run at the same time on many threads, so each is
// charged where it runs: by the clock of the thread, one stage at a time.

#pragma once

#include <array>
#include <cstddef>

namespace velamap {

enum class ImportStage {
  kDecode,    // from the file to a grey image
  kDetect,    // from there to markers, duplicates and rotations resolved, colours
  kRefine,    // corners to a fraction of a pixel
  kImages,    // frames of a video as JPEG, where they are asked for
  kDatabase,  // rows, matches, what needs all frames
};
inline constexpr std::size_t kNumImportStages = 5;

// "decode", "detect", "refine", "images", "database".
const char* ImportStageName(ImportStage stage);

struct BusyTime {
  double wall_s = 0.0;
  double cpu_s = 0.0;
};

// By ImportStage.
class ImportTimes {
 public:
  BusyTime& operator[](ImportStage stage) { return times_[static_cast<std::size_t>(stage)]; }
  const BusyTime& operator[](ImportStage stage) const {
    return times_[static_cast<std::size_t>(stage)];
  }
  ImportTimes& operator+=(const ImportTimes& other);
  double CpuSeconds() const;  // of all stages

 private:
  std::array<BusyTime, kNumImportStages> times_;
};

// Charges the time until its end to `stage`, and to no stage around it: the timer in whose life
// this one lies stands still meanwhile. Half a microsecond each.
class StageTimer {
 public:
  explicit StageTimer(ImportStage stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  int outer_;
};

// What the timers of this thread have charged since the last call.
ImportTimes TakeStageTimes();

// CPU time of the whole program so far, all threads.
double ProcessCpuSeconds();

}  // namespace velamap
