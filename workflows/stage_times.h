// Where the time of a run goes: wall time, CPU time and peak memory by stage.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace velamap {

struct StageTime {
  std::string name;
  double wall_s = 0.0;
  double cpu_s = 0.0;           // of all threads and of programs that were started, such as COLMAP
  int num_frames = 0;           // 0: the stage does not count frames
  double peak_memory_mb = 0.0;  // of this program since its start, resident
};

// Ends with its sum, "total".
class StageClock {
 public:
  StageClock();

  // Ends the stage that began with the last call, or with the clock.
  void End(const std::string& name, int num_frames = 0);

  std::vector<StageTime> Times() const;

 private:
  struct Instant {
    double wall_s = 0.0;
    double cpu_s = 0.0;
  };
  static Instant Now();

  Instant begin_;
  Instant last_;
  std::vector<StageTime> stages_;
};

// One line a stage, columns aligned, the first line their names.
std::vector<std::string> StageTable(const std::vector<StageTime>& times);

// An array of objects: stage, wall_s, cpu_s, num_frames and frames_per_s (where it counts frames),
// peak_memory_mb.
void WriteStageTimesJson(const std::vector<StageTime>& times, std::ostream& out);

}  // namespace velamap
