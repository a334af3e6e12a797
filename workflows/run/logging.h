// Log and errors: lines on stderr, and in a workspace's log file.

#pragma once

#include <string>
#include <vector>

namespace velamap {

// Sends spdlog's messages to stderr as `[hh:mm:ss] message`, with the level before warnings and
// errors. A progress bar (progress.h) is removed first.
void SetUpLogging();

enum class LogLevel { kError, kWarn, kInfo, kDebug };

void SetLogLevel(LogLevel level);

// The messages of level warning since SetUpLogging(), in order, at every log level.
std::vector<std::string> LoggedWarnings();

// Appends all later messages to this file, too. Throws InputError if it cannot be written.
void AddLogFile(const std::string& path);

// Writes one line `error: ...` to stderr, and to the log file if there is one.
void ReportError(const std::string& message);

}  // namespace velamap
