// Where the time of a run goes: wall time, CPU time and peak memory by stage.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "importer/base/stage_timer.h"

namespace velamap {

struct StageTime {
  std::string name;
  std::string part_of;  // the stage that this is a part of, and that holds its time; or empty
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

  // Ends the stage "import" and adds its parts, as the importer has measured them.
  void EndImport(const ImportTimes& parts, int num_frames);

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

// One line a stage, columns aligned, the first line their names; parts are set in, and their frames
// are counted by the second of CPU time.
std::vector<std::string> StageTable(const std::vector<StageTime>& times);

// The table to the log.
void LogStageTimes(const StageClock& clock);

// An array of objects: stage, part_of (where it is a part), wall_s, cpu_s, num_frames and
// frames_per_s, of a part frames_per_cpu_s (where it counts frames), peak_memory_mb.
void WriteStageTimesJson(const std::vector<StageTime>& times, std::ostream& out);

}  // namespace velamap
