// Runs the installed colmap program, without a shell.

#pragma once

#include <string>
#include <vector>

namespace velamap {

struct ColmapRun {
  std::string output;  // stdout and stderr
};

// Starts `program` (a name on the PATH, or a path) and waits for it. Its output is returned and
// appended to `log_path`, whose folder is made. No display is needed. Throws ExternalToolError if
// the program cannot be started, exits with a status other than 0, or is killed; the message holds
// the command line and the path of the log. Throws InputError if the log cannot be written. An
// interrupt from the terminal ends the child, too.
ColmapRun RunColmap(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& log_path);

// Tells whether `colmap COMMAND -h` lists the option (given without its dashes). Options differ
// between versions, and an unknown one is fatal. Every command is run once per process. Throws as
// RunColmap does.
bool ColmapHasOption(const std::string& program, const std::string& command,
                     const std::string& option);

}  // namespace velamap
