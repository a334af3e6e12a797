// Measures the time of each stage of an import. The stages run in parallel on many threads, so each
// thread charges its own time to the stage that it is in.

#pragma once

#include <array>
#include <cstddef>

namespace velamap {

enum class ImportStage {
  kFormation,  // estimating what camera and print do to edges, before all others
  kDecode,     // from the file to a grey image
  kDetect,     // from the grey image to markers with colours, duplicates and rotations resolved
  kRefine,     // corners to a fraction of a pixel
  kImages,     // writing frames of a video as JPEG
  kDatabase,   // writing rows and matches, and the steps that need all frames
};
inline constexpr std::size_t kNumImportStages = 6;

// "formation", "decode", "detect", "refine", "images", "database".
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

// Charges its lifetime to `stage`. An enclosing timer of the same thread is paused meanwhile. Takes
// half a microsecond.
class StageTimer {
 public:
  explicit StageTimer(ImportStage stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  int outer_;
};

// Measures the time of all threads of the program since its construction, for a stage during which
// no other stage runs.
class ProcessTimer {
 public:
  ProcessTimer();
  BusyTime Elapsed() const;

 private:
  BusyTime begin_;
};

// Returns the times that the timers of this thread have charged since the last call.
ImportTimes TakeStageTimes();

// CPU time of all threads of the program so far.
double ProcessCpuSeconds();

}  // namespace velamap
