// Runs the installed colmap program, without a shell.

#pragma once

#include <string>
#include <vector>

namespace velamap {

struct ColmapRun {
  int exit_status = 0;
  std::string output;  // stdout and stderr
};

// Starts `program` (a name on the PATH, or a path) with the arguments and waits for it. Output goes
// to `log_path` (appended) and into the result. Throws ExternalToolError if it cannot be started,
// exits with another status than 0, or is killed; the message holds the command line and the log's
// path. A user's interrupt ends the child too.
ColmapRun RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& log_path);

// Whether `colmap COMMAND -h` lists the option: flags differ between versions, and an unknown one
// is fatal. The text of one command is asked for once a process.
bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option);

}  // namespace velamap
