// Wall time, CPU time and peak memory of the stages of a run.

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "importer/base/stage_timer.h"

namespace velamap {

struct StageTime {
  std::string name;
  std::string part_of;  // the stage whose time includes this one's; empty for a stage of its own
  double wall_s = 0.0;
  double cpu_s = 0.0;           // of all threads and of started programs, such as COLMAP
  int num_frames = 0;           // 0: the stage does not count frames
  double peak_memory_mb = 0.0;  // resident memory of this program since its start
};

class StageClock {
 public:
  StageClock();

  // Ends the stage that began with the previous call or with the construction.
  void End(const std::string& name, int num_frames = 0);

  // Ends the stage "import" and adds its parts, which the importer has measured.
  void EndImport(const ImportTimes& parts, int num_frames);

  // All stages and their sum, "total".
  std::vector<StageTime> Times() const;

 private:
  BusyTime begin_;
  BusyTime last_;
  std::vector<StageTime> stages_;
};

// A header and one line for each stage. Parts are indented, and their frames/s are per second of
// CPU time.
std::vector<std::string> StageTable(const std::vector<StageTime>& times);

// Logs the table.
void LogStageTimes(const StageClock& clock);

// Writes an array of objects with the keys stage, part_of (of parts), wall_s, cpu_s, num_frames and
// frames_per_s (of parts frames_per_cpu_s; both where frames are counted), and peak_memory_mb.
void WriteStageTimesJson(const std::vector<StageTime>& times, std::ostream& out);

}  // namespace velamap
