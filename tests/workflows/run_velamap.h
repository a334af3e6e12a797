// Runs the real program as a user's shell would.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace velamap {

struct ProgramRun {
  int exit_code = -1;  // -1: ended by a signal
  std::string out;
  std::string err;
};

struct ProgramLimits {
  // Largest file that the program may write, bytes: what a full disk looks like without needing
  // privileges.
  std::optional<unsigned long> max_file_size;
  // The program may start no thread and no process (ulimit -u). The superuser, who has no such
  // limit, runs it as a user without privileges.
  bool has_no_threads = false;
};

using MainFunction = std::function<int(int argc, char** argv)>;

// Runs `main` in a child of this process, with `program` as argv[0]. It need not load its libraries
// again, which takes the program longer than to refuse an input.
ProgramRun RunInChild(const std::string& program, const std::vector<std::string>& arguments,
                      const ProgramLimits& limits, const MainFunction& main);

// `program` is a path. Throws std::runtime_error if it cannot be started.
ProgramRun RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                      const ProgramLimits& limits = {});

ProgramRun RunVelamap(const std::vector<std::string>& arguments, const ProgramLimits& limits = {});

// Number of lines that are not log lines (`[hh:mm:ss] ...`); a failure has one, `error: ...`.
int NumErrorLines(const std::string& err);

// Names of what a folder holds, sorted, hidden files too; empty where there is no folder.
std::vector<std::string> ListFolder(const std::filesystem::path& folder);

void WriteTextFile(const std::filesystem::path& path, const std::string& text);
std::string ReadFileBytes(const std::filesystem::path& path);

}  // namespace velamap
