#include "reconstruct/colmap/colmap_runner.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string CommandLine(const std::string& program, const std::vector<std::string>& arguments) {
  std::string line = program;
  for (const std::string& argument : arguments) {
    line += argument.find(' ') == std::string::npos ? " " + argument : " '" + argument + "'";
  }
  return line;
}

// Owns both ends of a pipe.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) Fail();
    for (int& end : ends_) MoveBeyondStandardStreams(&end);
  }
  ~Pipe() {
    CloseWriteEnd();
    close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int WriteEnd() const { return ends_[1]; }
  void CloseWriteEnd() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }

  // Waits for output. Returns an empty string once every writer has closed its end.
  std::string Read() const {
    std::array<char, 4096> buffer;
    ssize_t size;
    do {
      size = read(ends_[0], buffer.data(), buffer.size());
    } while (size < 0 && errno == EINTR);
    return std::string(buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  }

 private:
  [[noreturn]] static void Fail() {
    throw ExternalToolError(
        fmt::format("a pipe for COLMAP's output cannot be made: {}", std::strerror(errno)));
  }

  // Where our own stdin is closed, an end of the pipe would get its number, which the child's stdin
  // needs.
  static void MoveBeyondStandardStreams(int* end) {
    if (*end > STDERR_FILENO) return;
    const int moved = fcntl(*end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (moved < 0) Fail();
    close(*end);
    *end = moved;
  }

  std::array<int, 2> ends_{};
};

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Our environment, with a Qt platform that needs no display, because some commands of COLMAP start
// Qt, and with `scratch_path` for the logs that it writes into TMPDIR and leaves there.
std::vector<std::string> ChildEnvironment(const std::string& scratch_path) {
  std::map<std::string, std::string> own = {{"QT_QPA_PLATFORM", "offscreen"}};
  if (!scratch_path.empty()) own["TMPDIR"] = scratch_path;
  std::vector<std::string> variables;
  for (const auto& [name, value] : own) variables.push_back(name + "=" + value);
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (own.count(text.substr(0, text.find('='))) == 0) variables.push_back(text);
  }
  return variables;
}

// The child stays in our process group, so that an interrupt from the terminal reaches it.
pid_t Spawn(const std::string& program, const std::vector<std::string>& arguments,
            const std::string& scratch_path, int output_fd) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = ChildEnvironment(scratch_path);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output_fd, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output_fd, STDERR_FILENO);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, program.c_str(), &actions, nullptr, Pointers(words).data(),
                                 Pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw ExternalToolError(fmt::format(
        "{}: cannot be started: {}; install COLMAP (apt install colmap) or name its program with "
        "--colmap_path",
        program, std::strerror(error)));
  }
  return pid;
}

int WaitFor(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

// Quotes the first line of COLMAP's output that looks like an error, else the last line.
std::string DescribeOutput(const std::string& output) {
  std::string last, line;
  std::istringstream lines(output);
  while (std::getline(lines, line)) {
    for (const char* sign : {"ERROR", "Check failed", "what():"}) {
      if (line.find(sign) != std::string::npos) return "it wrote: " + line;
    }
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  return last.empty() ? "it wrote nothing" : "it wrote last: " + last;
}

// Returns an empty string if the program succeeded.
std::string DescribeFailure(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    return fmt::format("was killed by signal {} ({}){}", signal, strsignal(signal),
                       signal == SIGKILL ? ", perhaps because memory ran out" : "");
  }
  if (WEXITSTATUS(wait_status) != 0) {
    return fmt::format("exited with status {}", WEXITSTATUS(wait_status));
  }
  return "";
}

std::ofstream OpenLog(const std::string& log_path) {
  CreateFolders(AbsolutePath(log_path).parent_path());
  std::ofstream log(log_path, std::ios::app | std::ios::binary);
  if (!log) throw InputError(fmt::format("{}: the log cannot be written", log_path));
  return log;
}

}  // namespace

ColmapRun RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& log_path) {
  const std::string command_line = CommandLine(program, arguments);
  std::ofstream log = OpenLog(log_path);
  log << "$ " << command_line << std::endl;

  std::optional<TemporaryFolder> scratch;
  try {
    scratch.emplace();
  } catch (const InputError&) {
    // COLMAP does without.
  }
  Pipe pipe;
  const pid_t pid =
      Spawn(program, arguments, scratch ? scratch->path().string() : "", pipe.WriteEnd());
  pipe.CloseWriteEnd();
  ColmapRun run;
  for (std::string text = pipe.Read(); !text.empty(); text = pipe.Read()) {
    log << text << std::flush;
    run.output += text;
  }
  const std::string failure = DescribeFailure(WaitFor(pid));
  if (!failure.empty()) {
    log << "(" << failure << ")\n";
    throw ExternalToolError(fmt::format("COLMAP {}: {}; {}; log: {}", failure, command_line,
                                        DescribeOutput(run.output), log_path));
  }
  return run;
}

bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, std::string> help_texts;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto key = std::make_pair(program, command);
  if (help_texts.count(key) == 0) {
    help_texts[key] = RunColmap(program, {command, "-h"}, "/dev/null").output;
  }
  std::istringstream words(help_texts.at(key));
  for (std::string word; words >> word;) {
    if (word == "--" + option) return true;
  }
  return false;
}

}  // namespace velamap
