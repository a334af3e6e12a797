// A program in its own process group, started without a shell. It ends when this process ends,
// however that happens.

#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace velamap {

// Owns both ends of a pipe.
class Pipe {
 public:
  Pipe();  // throws std::system_error
  ~Pipe();
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int ReadEnd() const { return ends_[0]; }
  int WriteEnd() const { return ends_[1]; }
  void CloseWriteEnd();

 private:
  std::array<int, 2> ends_{};
};

class ChildProcess {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Starts `words`, the program (a name on the PATH, or a path) and its arguments, with the
  // variables `environment` ("NAME=value") only. Its standard input is empty. Throws
  // std::system_error if the system cannot start another process. The program and whatever it has
  // started in its group are killed when the program ends, when this object is destroyed, and when
  // the thread that created it or the whole process ends.
  ChildProcess(std::vector<std::string> words, std::vector<std::string> environment);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Waits for output on stdout or stderr and returns it: an empty text once the program and
  // whatever it has started have ended or closed both, and nothing at the deadline.
  std::optional<std::string> Read(Time deadline) const;

  // Waits for the end and returns the status of waitpid(); nothing at the deadline. Throws
  // std::system_error with the reason if the program could not be started.
  std::optional<int> Wait(Time deadline) const;

 private:
  Pipe output_, report_;
  pid_t watcher_ = -1;
};

}  // namespace velamap
