#include "tests/workflows/run_velamap.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

constexpr int kNotStarted = 127;  // the exit code of a shell that cannot start a program

// Prepares a child for what it runs: its streams go to the files.
void Prepare(const ProgramLimits& limits, const std::string& out_path,
             const std::string& err_path) {
  dup2(open(out_path.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
  dup2(open(err_path.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
  if (limits.max_file_size) {
    const rlimit limit{*limits.max_file_size, *limits.max_file_size};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (limits.has_no_threads) {
    constexpr unsigned kUnusedId = 54321;
    const rlimit limit{1, 1};
    setrlimit(RLIMIT_NPROC, &limit);
    if (geteuid() == 0 && (setgid(kUnusedId) != 0 || setuid(kUnusedId) != 0)) _exit(kNotStarted);
  }
}

}  // namespace

ProgramRun RunInChild(const std::string& program, const std::vector<std::string>& arguments,
                      const ProgramLimits& limits, const MainFunction& main) {
  const TempDir temp_dir;
  const std::string out_path = (temp_dir / "out").string(), err_path = (temp_dir / "err").string();
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::fflush(nullptr);  // or the child writes what waits in the buffers, too
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("fork failed");
  if (pid == 0) {
    Prepare(limits, out_path, err_path);
    const int exit_code = main(static_cast<int>(argv.size()) - 1, argv.data());
    std::fflush(nullptr);
    _exit(exit_code);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted) {
    throw std::runtime_error("cannot start " + program);
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFileBytes(out_path),
          ReadFileBytes(err_path)};
}

ProgramRun RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                      const ProgramLimits& limits) {
  return RunInChild(program, arguments, limits, [](int, char** argv) {
    execv(argv[0], argv);
    return kNotStarted;
  });
}

ProgramRun RunVelamap(const std::vector<std::string>& arguments, const ProgramLimits& limits) {
  return RunProgram(VELAMAP_PROGRAM, arguments, limits);
}

int NumErrorLines(const std::string& err) {
  std::istringstream stream(err);
  int num_lines = 0;
  for (std::string line; std::getline(stream, line);) num_lines += line.rfind('[', 0) != 0;
  return num_lines;
}

std::vector<std::string> ListFolder(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void WriteTextFile(const std::filesystem::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string ReadFileBytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace velamap
