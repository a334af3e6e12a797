// The program: finds the command, and turns what it throws into a line and an exit code.

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include "importer/base/error.h"
#include "workflows/commands/commands.h"
#include "workflows/run/logging.h"

namespace velamap {
namespace {

enum ExitCode { kOk = 0, kNoResult = 1, kBadInput = 2, kExternalTool = 3, kBrokenInvariant = 4 };

// Where the caller has closed a standard stream, a file of ours would take its number, and text
// that is meant for the terminal would go into it. What takes its place cannot be written to.
void OccupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDONLY);  // takes the lowest free number
  }
}

void Run(const Arguments& arguments) {
  const std::string name = arguments.empty() ? "help" : arguments.front();
  if (name == "--help" || name == "-h") {
    RunHelp({});
  } else if (name == "--version") {
    RunVersion({});
  } else {
    FindCommand(name).run({arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end()});
  }
  std::cout.flush();
  if (!std::cout) throw InputError("standard output: cannot be written; is the disk full?");
}

int Main(int argc, char** argv) {
  const auto fail = [](ExitCode code, const std::string& message) {
    ReportError(message);
    return code;
  };
  try {
    OccupyStandardStreams();
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
    return fail(kBrokenInvariant,
                "out of memory; give fewer frames (--Video.frame_step) or fewer --num_threads");
  } catch (const std::exception& error) {
    return fail(kBrokenInvariant, std::string(error.what()) + " (an error of velamap itself)");
  }
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::Main(argc, argv); }
