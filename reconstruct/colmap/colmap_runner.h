// Runs the installed colmap program, without a shell. It is stopped when velamap ends
// (importer/process/child_process.h).

#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace velamap {

// The longest time that a run may take before it is stopped.
struct ColmapLimit {
  std::chrono::duration<double> time;
  std::string set_by;  // named in the message, such as an option
};

// For questions that COLMAP answers at once.
inline const ColmapLimit kColmapHelpLimit = {std::chrono::minutes(2), "the limit for its help"};

// The log path of a run that leaves no log.
constexpr const char* kNoLog = "/dev/null";

// Starts `program` (a name on the PATH, or a path) and waits for it. Its output (stdout and stderr)
// is returned and appended to `log_path`, whose folder is created if it is missing; the log shows
// names of files without their folders (importer/text/shown_text.h). No display is needed. Throws
// ExternalToolError if the program cannot be started, exits with a status other than 0, is killed,
// or runs beyond the limit; the message holds the command line and, unless that is kNoLog, the path
// of the log. Throws InputError if the log cannot be written, or no folder for temporary files can
// be made.
std::string RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                      const std::string& log_path, const ColmapLimit& limit = kColmapHelpLimit);

// Tells whether `colmap COMMAND -h` lists the option (given without its dashes). Options differ
// between versions, and an unknown one is fatal. The help of each command is read once per process.
// Throws as RunColmap does.
bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option);

}  // namespace velamap
