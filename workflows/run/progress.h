// Progress of a long step: a bar with the time left on a terminal, log lines elsewhere.

#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace velamap {

// Shows nothing within the first second. On a terminal (stderr) a bar is redrawn at most ten times
// a second and removed at the end. Elsewhere a line is logged every 10 s or every 10 %, but at most
// one a second. Update() may be called from any thread.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `total` 0: unknown. `message` says what was done last. With nothing done, the clock restarts,
  // because the time before says nothing about the time that is left.
  void Update(int done, int total, const std::string& message);

 private:
  using Clock = std::chrono::steady_clock;

  std::mutex mutex_;
  std::string what_;
  bool on_terminal_;
  Clock::time_point start_;
  Clock::time_point last_shown_;
  int last_percent_ = 0;
};

// `what: 120/400, 30 %, 45.2/s, 6 s left`; without a total `what: 120, 45.2/s`.
std::string ProgressText(const std::string& what, int done, int total, double elapsed_s);

// `[#####     ] `, `width` characters between the brackets.
std::string ProgressBar(int done, int total, int width);

// Removes the bar from the terminal, so that a line can be written there.
void ClearProgressLine();

}  // namespace velamap
