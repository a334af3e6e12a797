#include "reconstruct/colmap/colmap_runner.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/process/child_process.h"
#include "importer/text/shown_text.h"

namespace velamap {
namespace {

// No normal run of COLMAP writes this much, but a runaway one could fill the disk.
constexpr std::size_t kMaxOutputSize = std::size_t{64} << 20;

std::string CommandLine(const std::string& program, const std::vector<std::string>& arguments) {
  std::string line = program;
  for (const std::string& argument : arguments) {
    line += argument.find(' ') == std::string::npos ? " " + argument : " '" + argument + "'";
  }
  return line;
}

// Our environment, with a Qt platform that needs no display, because some commands of COLMAP start
// Qt, and with `scratch_path` for the logs that it writes into TMPDIR and leaves there.
std::vector<std::string> ChildEnvironment(const std::string& scratch_path) {
  std::map<std::string, std::string> own = {{"QT_QPA_PLATFORM", "offscreen"},
                                            {"TMPDIR", scratch_path}};
  std::vector<std::string> variables;
  for (const auto& [name, value] : own) variables.push_back(name + "=" + value);
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (own.count(text.substr(0, text.find('='))) == 0) variables.push_back(text);
  }
  return variables;
}

// Quotes the first line of COLMAP's output that looks like an error, else the last line.
std::string DescribeOutput(const std::string& output) {
  constexpr std::size_t kMaxQuoted = 500;
  std::string last, line;
  std::istringstream lines(output);
  while (std::getline(lines, line)) {
    for (const char* sign : {"ERROR", "Check failed", "what():"}) {
      if (line.find(sign) != std::string::npos) return "it wrote: " + line.substr(0, kMaxQuoted);
    }
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line.substr(0, kMaxQuoted);
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

// The log, which shows no folders (importer/text/shown_text.h).
class Log {
 public:
  explicit Log(const std::string& path) {
    CreateFolders(CanonicalPath(path).parent_path());
    stream_.open(path, std::ios::app | std::ios::binary);
    if (!stream_) throw InputError(fmt::format("{}: the log cannot be written", path));
  }
  ~Log() { stream_ << StripFolders(unfinished_); }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void Write(const std::string& text) {
    const std::size_t end = text.rfind('\n') + 1;
    unfinished_.append(text, 0, end);
    if (end > 0) {
      stream_ << StripFolders(unfinished_) << std::flush;
      unfinished_.clear();
    }
    unfinished_.append(text, end);
  }

 private:
  std::ofstream stream_;
  std::string unfinished_;  // the last line, which may break off within a name
};

[[noreturn]] void ThrowNotStarted(const std::string& program, const std::error_code& error) {
  if (error == std::errc::resource_unavailable_try_again) throw std::system_error(error);
  throw ExternalToolError(fmt::format(
      "{}: cannot be started: {}; install COLMAP (apt install colmap) or name its program with "
      "--colmap_path",
      program, error.message()));
}

// Runs the program to its end. Returns how it failed; an empty string if it succeeded.
std::string RunInto(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& scratch_path, const ColmapLimit& limit, Log* log,
                    std::string* output) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  try {
    const ChildProcess child(words, ChildEnvironment(scratch_path));
    const auto deadline = std::chrono::steady_clock::now() +
                          std::chrono::duration_cast<std::chrono::nanoseconds>(limit.time);
    while (output->size() <= kMaxOutputSize) {
      const std::optional<std::string> text = child.Read(deadline);
      if (text && !text->empty()) {
        log->Write(*text);
        *output += *text;
        continue;
      }
      const std::optional<int> status = text ? child.Wait(deadline) : std::nullopt;
      if (status) return DescribeFailure(*status);
      return fmt::format("had not ended after {:.3g} minutes ({}) and was ended",
                         std::chrono::duration<double, std::ratio<60>>(limit.time).count(),
                         limit.set_by);
    }
    return fmt::format("wrote more than {} bytes and was ended", kMaxOutputSize);
  } catch (const std::system_error& error) {
    ThrowNotStarted(program, error.code());
  }
}

}  // namespace

std::string RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                      const std::string& log_path, const ColmapLimit& limit) {
  const std::string command_line = CommandLine(program, arguments);
  Log log(log_path);
  log.Write("$ " + command_line + "\n");
  const TemporaryFolder scratch;
  std::string output;
  const std::string failure = RunInto(program, arguments, scratch.path(), limit, &log, &output);
  if (!failure.empty()) {
    log.Write("(" + failure + ")\n");
    throw ExternalToolError(fmt::format("COLMAP {}: {}; {}{}", failure, command_line,
                                        DescribeOutput(output),
                                        log_path == kNoLog ? "" : "; log: " + log_path));
  }
  return output;
}

bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, std::string> help_texts;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto key = std::make_pair(program, command);
  if (help_texts.count(key) == 0) {
    help_texts[key] = RunColmap(program, {command, "-h"}, kNoLog);
  }
  std::istringstream words(help_texts.at(key));
  for (std::string word; words >> word;) {
    if (word == "--" + option) return true;
  }
  return false;
}

}  // namespace velamap
