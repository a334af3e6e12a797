// The program without its main(), so that a test can run it in a child process of its own.

#pragma once

namespace velamap {

// Runs the command line. An exception becomes one line on standard error and the exit code that is
// returned; none leaves it.
int Main(int argc, char** argv);

}  // namespace velamap
