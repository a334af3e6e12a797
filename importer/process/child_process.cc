#include "importer/process/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <system_error>

namespace velamap {
namespace {

[[noreturn]] void ThrowSystemError(int error) {
  throw std::system_error(error, std::generic_category());
}

// If one of our own standard streams is closed, a pipe would get its number, which the child's
// stream needs.
void MoveBeyondStandardStreams(int* end) {
  if (*end > STDERR_FILENO) return;
  const int moved = fcntl(*end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (moved < 0) ThrowSystemError(errno);
  close(*end);
  *end = moved;
}

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

// What comes through the report's pipe. It is written in one piece.
struct Report {
  int start_error;  // errno; 0 if the program has run
  int status;       // from waitpid()
};

// All that the forked processes need. They may call nothing that is not async-signal-safe, because
// other threads of ours may have held locks.
struct Start {
  char* const* words;
  char* const* environment;
  int output_fd, report_fd;
  pid_t parent;
  sigset_t watched, original;
};

void Send(const Start& start, const Report& report) {
  const ssize_t written = write(start.report_fd, &report, sizeof(report));
  static_cast<void>(written);  // nobody is left to tell
}

[[noreturn]] void RunProgram(const Start& start) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // if somebody kills the watcher
  sigprocmask(SIG_SETMASK, &start.original, nullptr);
  const int empty = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (dup2(empty, STDIN_FILENO) >= 0 && dup2(start.output_fd, STDOUT_FILENO) >= 0 &&
      dup2(start.output_fd, STDERR_FILENO) >= 0) {
    execvpe(start.words[0], start.words, start.environment);
  }
  Send(start, {errno, 0});
  _exit(EXIT_FAILURE);
}

// The leader of the group: starts the program and waits until it or the parent has ended. A death
// signal to the program alone would not end the processes that a script has started.
[[noreturn]] void Watch(const Start& start) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  signal(SIGCHLD, SIG_DFL);  // a caller may have it ignored, and then there is no signal
  if (setpgid(0, 0) != 0 || getppid() != start.parent) _exit(EXIT_FAILURE);
  const pid_t program = fork();
  if (program == 0) RunProgram(start);
  if (program < 0) {
    Send(start, {errno, 0});
    _exit(EXIT_FAILURE);
  }
  // Releases the parent's files, including its lock, and its terminal.
  close_range(0, static_cast<unsigned>(start.report_fd) - 1, 0);
  close_range(static_cast<unsigned>(start.report_fd) + 1, UINT_MAX, 0);
  while (true) {
    int received = 0, status = 0;
    sigwait(&start.watched, &received);
    if (received == SIGTERM) break;
    if (waitpid(program, &status, WNOHANG) != program) continue;
    Send(start, {0, status});
    break;
  }
  kill(0, SIGKILL);  // the whole group
  _exit(EXIT_FAILURE);
}

// Whether there is something to read, or the other end is closed, before the deadline.
bool WaitForInput(int file, ChildProcess::Time deadline) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    const auto left_ms = std::clamp<std::int64_t>(left.count() + 1, 0, INT_MAX);
    pollfd polled{file, POLLIN, 0};
    const int count = poll(&polled, 1, static_cast<int>(left_ms));
    if (count > 0) return true;
    if (count < 0 && errno != EINTR) ThrowSystemError(errno);
    if (std::chrono::steady_clock::now() >= deadline) return false;
  }
}

}  // namespace

Pipe::Pipe() {
  if (pipe2(ends_.data(), O_CLOEXEC) != 0) ThrowSystemError(errno);
  for (int& end : ends_) MoveBeyondStandardStreams(&end);
}

Pipe::~Pipe() {
  CloseWriteEnd();
  close(ends_[0]);
}

void Pipe::CloseWriteEnd() {
  if (ends_[1] >= 0) close(ends_[1]);
  ends_[1] = -1;
}

ChildProcess::ChildProcess(std::vector<std::string> words, std::vector<std::string> environment) {
  const std::vector<char*> word_pointers = Pointers(words), variables = Pointers(environment);
  Start start{word_pointers.data(),
              variables.data(),
              output_.WriteEnd(),
              report_.WriteEnd(),
              getpid(),
              {},
              {}};
  sigemptyset(&start.watched);
  sigaddset(&start.watched, SIGTERM);
  sigaddset(&start.watched, SIGCHLD);
  // Before the watcher exists, so that it misses none.
  pthread_sigmask(SIG_BLOCK, &start.watched, &start.original);
  watcher_ = fork();
  if (watcher_ == 0) Watch(start);
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &start.original, nullptr);
  if (watcher_ < 0) ThrowSystemError(error);
  setpgid(watcher_, watcher_);  // it does the same; whoever is first
  output_.CloseWriteEnd();
  report_.CloseWriteEnd();
}

ChildProcess::~ChildProcess() {
  kill(-watcher_, SIGKILL);
  while (waitpid(watcher_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<std::string> ChildProcess::Read(Time deadline) const {
  if (!WaitForInput(output_.ReadEnd(), deadline)) return std::nullopt;
  std::array<char, 65536> buffer;
  ssize_t size = 0;
  do {
    size = read(output_.ReadEnd(), buffer.data(), buffer.size());
  } while (size < 0 && errno == EINTR);
  return std::string(buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
}

std::optional<int> ChildProcess::Wait(Time deadline) const {
  if (!WaitForInput(report_.ReadEnd(), deadline)) return std::nullopt;
  Report report{};
  if (read(report_.ReadEnd(), &report, sizeof(report)) != sizeof(report)) return SIGKILL;
  if (report.start_error != 0) ThrowSystemError(report.start_error);
  return report.status;
}

}  // namespace velamap
