#include "workflows/run/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "importer/base/log.h"
#include "workflows/run/logging.h"

namespace velamap {
namespace {

constexpr double kQuietSeconds = 1.0;

// The state of the bar, which is the last line of the terminal. The process has one terminal.
std::mutex terminal_mutex;
bool line_shown = false;

std::size_t TerminalColumns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

void ShowProgressLine(std::string line) {
  const std::lock_guard<std::mutex> lock(terminal_mutex);
  line.resize(std::min(line.size(), TerminalColumns() - 1));
  std::fprintf(stderr, "\r\033[K%s", Printable(line).c_str());
  std::fflush(stderr);
  line_shown = true;
}

std::string TimeText(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

int Percent(int done, int total) {
  return total > 0 ? static_cast<int>(100.0 * std::min(done, total) / total) : 0;
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_shown_(start_) {}

Progress::~Progress() { ClearProgressLine(); }

void Progress::Update(int done, int total, const std::string& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (done == 0) {
    start_ = last_shown_ = now;
    last_percent_ = 0;
  }
  const double elapsed_s = Seconds(now - start_);
  const double since_last_s = Seconds(now - last_shown_);
  if (elapsed_s < kQuietSeconds) return;
  const int percent = Percent(done, total);
  if (on_terminal_) {
    if (since_last_s < 0.1) return;
    ShowProgressLine(ProgressBar(done, total, 20) + ProgressText(what_, done, total, elapsed_s) +
                     (message.empty() ? "" : "  " + message));
  } else {
    const bool due = since_last_s >= 10.0 || (since_last_s >= 1.0 && percent >= last_percent_ + 10);
    if (!due) return;
    LogInfo(ProgressText(what_, done, total, elapsed_s));
  }
  last_shown_ = now;
  last_percent_ = percent;
}

std::string ProgressText(const std::string& what, int done, int total, double elapsed_s) {
  const double rate = elapsed_s > 0 ? done / elapsed_s : 0.0;
  if (total <= 0) return fmt::format("{}: {}, {:.1f}/s", what, done, rate);
  std::string text =
      fmt::format("{}: {}/{}, {} %, {:.1f}/s", what, done, total, Percent(done, total), rate);
  if (rate > 0) text += fmt::format(", {} left", TimeText(std::max(0, total - done) / rate));
  return text;
}

std::string ProgressBar(int done, int total, int width) {
  if (total <= 0) return "";
  const int filled = Percent(done, total) * width / 100;
  return fmt::format("[{}{}] ", std::string(static_cast<std::size_t>(filled), '#'),
                     std::string(static_cast<std::size_t>(width - filled), ' '));
}

void ClearProgressLine() {
  const std::lock_guard<std::mutex> lock(terminal_mutex);
  if (!line_shown) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  line_shown = false;
}

}  // namespace velamap
