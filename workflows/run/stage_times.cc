#include "workflows/run/stage_times.h"

#include <sys/resource.h>

#include <chrono>
#include <optional>
#include <ostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/base/log.h"

namespace velamap {
namespace {

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double CpuSeconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
}

BusyTime Now() {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
  return {wall.count(), CpuSeconds(RUSAGE_SELF) + CpuSeconds(RUSAGE_CHILDREN)};
}

double PeakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux reports KiB
}

// Returns nothing without frames and below a millisecond, where the clocks give no rate. Parts run
// in parallel and wait for each other, so their rate is by CPU time.
std::optional<double> FramesPerSecond(const StageTime& time) {
  constexpr double kMinSeconds = 1e-3;
  const double seconds = time.part_of.empty() ? time.wall_s : time.cpu_s;
  if (time.num_frames == 0 || seconds < kMinSeconds) return std::nullopt;
  return time.num_frames / seconds;
}

}  // namespace

StageClock::StageClock() : begin_(Now()), last_(begin_) {}

void StageClock::End(const std::string& name, int num_frames) {
  const BusyTime now = Now();
  stages_.push_back(
      {name, "", now.wall_s - last_.wall_s, now.cpu_s - last_.cpu_s, num_frames, PeakMemoryMb()});
  last_ = now;
}

void StageClock::EndImport(const ImportTimes& parts, int num_frames) {
  End("import", num_frames);
  const double peak_memory_mb = stages_.back().peak_memory_mb;
  for (std::size_t i = 0; i < kNumImportStages; ++i) {
    const auto stage = static_cast<ImportStage>(i);
    const BusyTime& time = parts[stage];
    if (time.wall_s == 0) continue;
    // The formation is estimated from a few frames, however many there are.
    const int num_frames_of_part = stage == ImportStage::kFormation ? 0 : num_frames;
    stages_.push_back({ImportStageName(stage), "import", time.wall_s, time.cpu_s,
                       num_frames_of_part, peak_memory_mb});
  }
}

std::vector<StageTime> StageClock::Times() const {
  std::vector<StageTime> times = stages_;
  times.push_back(
      {"total", "", last_.wall_s - begin_.wall_s, last_.cpu_s - begin_.cpu_s, 0, PeakMemoryMb()});
  return times;
}

std::vector<std::string> StageTable(const std::vector<StageTime>& times) {
  std::vector<std::string> lines = {
      fmt::format("{:<11} {:>8} {:>8} {:>8} {:>8}", "stage", "wall s", "CPU s", "frames/s", "MB")};
  for (const StageTime& time : times) {
    const std::optional<double> frames_per_s = FramesPerSecond(time);
    const std::string rate = frames_per_s ? fmt::format("{:.1f}", *frames_per_s) : std::string();
    const std::string name = (time.part_of.empty() ? "" : "  ") + time.name;
    lines.push_back(fmt::format("{:<11} {:>8.2f} {:>8.2f} {:>8} {:>8.0f}", name, time.wall_s,
                                time.cpu_s, rate, time.peak_memory_mb));
  }
  return lines;
}

void LogStageTimes(const StageClock& clock) {
  for (const std::string& line : StageTable(clock.Times())) LogInfo("{}", line);
}

void WriteStageTimesJson(const std::vector<StageTime>& times, std::ostream& out) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const StageTime& time : times) {
    nlohmann::ordered_json stage = {{"stage", time.name}};
    if (!time.part_of.empty()) stage["part_of"] = time.part_of;
    stage["wall_s"] = time.wall_s;
    stage["cpu_s"] = time.cpu_s;
    if (time.num_frames > 0) stage["num_frames"] = time.num_frames;
    if (const std::optional<double> frames_per_s = FramesPerSecond(time)) {
      stage[time.part_of.empty() ? "frames_per_s" : "frames_per_cpu_s"] = *frames_per_s;
    }
    stage["peak_memory_mb"] = time.peak_memory_mb;
    json.push_back(std::move(stage));
  }
  out << json.dump(1) << '\n';
}

}  // namespace velamap
