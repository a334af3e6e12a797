#include "workflows/commands/program.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>

#include <opencv2/core.hpp>

#include "importer/base/error.h"
#include "importer/base/parallel.h"
#include "workflows/commands/commands.h"
#include "workflows/run/logging.h"

namespace velamap {
namespace {

constexpr char kOutOfMemory[] = "out of memory; use fewer images or fewer threads";

enum ExitCode { kOk = 0, kNoResult = 1, kBadInput = 2, kExternalTool = 3, kBrokenInvariant = 4 };

// If the caller has closed a standard stream, the next file that is opened takes its number and
// gets the text for the terminal. A stream that cannot be written to takes the number instead.
void OccupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDONLY);  // takes the lowest free number
  }
}

// Removes control characters from standard output during its lifetime.
class PrintableStdout {
 public:
  PrintableStdout() : printable_(std::cout.rdbuf()), original_(std::cout.rdbuf(&printable_)) {}
  ~PrintableStdout() { std::cout.rdbuf(original_); }
  PrintableStdout(const PrintableStdout&) = delete;
  PrintableStdout& operator=(const PrintableStdout&) = delete;

 private:
  PrintableOutput printable_;
  std::streambuf* original_;
};

void Run(const Arguments& arguments) {
  const PrintableStdout printable;
  RunCommandLine(arguments);
  std::cout.flush();
  if (!std::cout) throw InputError("standard output: cannot be written; is the disk full?");
}

}  // namespace

int Main(int argc, char** argv) {
  const auto fail = [](ExitCode code, const std::string& message) {
    ReportError(message);
    return code;
  };
  try {
    OccupyStandardStreams();
    // A limit of the shell (ulimit -f) is then an error of the file, as a full disk is.
    std::signal(SIGXFSZ, SIG_IGN);
    UseOwnThreadsOnly();
    SetUpLogging();
    Run({argv + 1, argv + argc});
    return kOk;
  } catch (const InputError& error) {
    return fail(kBadInput, error.what());
  } catch (const DataError& error) {
    return fail(kNoResult, error.what());
  } catch (const ExternalToolError& error) {
    return fail(kExternalTool, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kBadInput, kOutOfMemory);
  } catch (const std::exception& error) {
    const auto* opencv_error = dynamic_cast<const cv::Exception*>(&error);
    if (opencv_error != nullptr && opencv_error->code == cv::Error::StsNoMem) {
      return fail(kBadInput, kOutOfMemory);
    }
    const auto* system_error = dynamic_cast<const std::system_error*>(&error);
    if (system_error != nullptr &&
        system_error->code() == std::errc::resource_unavailable_try_again) {
      return fail(kBadInput,
                  "the system cannot start more threads or processes; raise the limit of processes "
                  "(ulimit -u), or end other programs");
    }
    return fail(
        kBrokenInvariant,
        std::string(error.what()) +
            " (a bug in velamap; please report it with this line, the command and the log)");
  }
}

}  // namespace velamap
