// Runs the installed colmap program, without a shell.

#pragma once

#include <string>
#include <vector>

namespace velamap {

struct ColmapRun {
  std::string output;  // stdout and stderr
};

// Starts `program` (a name on the PATH, or a path) with the arguments and waits for it. Output goes
// to `log_path` (appended; its folder is made) and into the result. No display is needed. Throws
// ExternalToolError if it cannot be started, exits with another status than 0, or is killed; the
// message holds the command line and the log's path. Throws InputError if the log cannot be
// written. An interrupt from the terminal ends the child too.
ColmapRun RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& log_path);

// Whether `colmap COMMAND -h` lists the option (without its dashes): flags differ between versions,
// and an unknown one is fatal. The text of one command is asked for once a process. Throws as
// RunColmap does.
bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option);

}  // namespace velamap
