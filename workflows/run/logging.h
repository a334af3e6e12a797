// Log and errors: lines on stderr, and in a workspace's log file.

#pragma once

#include <string>

namespace velamap {

// Sends spdlog's messages to stderr as `[hh:mm:ss] message`; problems are marked by their level. A
// progress bar (progress.h) makes room for them.
void SetUpLogging();

// error, warn, info or debug. Throws InputError for another name.
void SetLogLevel(const std::string& name);

// From here on messages go to this file too (appended). Throws InputError if it cannot be written.
void AddLogFile(const std::string& path);

// One line `error: ...` on stderr, and in the log file if there is one.
void ReportError(const std::string& message);

}  // namespace velamap
