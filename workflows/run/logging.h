// Log and errors: lines on stderr, and in a workspace's log file.

#pragma once

#include <streambuf>
#include <string>
#include <vector>

#include "importer/base/log.h"

namespace velamap {

// Sends the log (importer/base/log.h) to stderr as `[hh:mm:ss] message`, with the level before
// warnings and errors. A progress bar (progress.h) is removed first.
void SetUpLogging();

// The logger always passes on warnings; terminal and file drop the levels that were not asked for.
void SetLogLevel(LogLevel level);

// The messages of level warning since SetUpLogging(), in order, at every log level.
std::vector<std::string> LoggedWarnings();

// Also appends all later messages to this file, without the folders of files that they name
// (importer/text/shown_text.h). Throws InputError if it cannot be written.
void AddLogFile(const std::string& path);

// The text with a ? for each control character except tab and line feed. File names may hold any of
// them, and they could change what a terminal shows.
std::string Printable(std::string text);

// Passes text on as Printable() gives it.
class PrintableOutput : public std::streambuf {
 public:
  explicit PrintableOutput(std::streambuf* out) : out_(out) {}

 protected:
  int overflow(int character) override;
  int sync() override { return out_->pubsync(); }

 private:
  std::streambuf* out_;
  char before_ = '\0';
};

// Writes one line `error: ...` to stderr, and to the log file if there is one.
void ReportError(const std::string& message);

}  // namespace velamap
