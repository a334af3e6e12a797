// Options of the tools that render and evaluate clips.

#pragma once

#include <string>

#include <boost/program_options.hpp>

namespace velamap {

// Throws InputError that names the option and the range if `value` is out of range or NaN.
void CheckOptionRange(const char* option, double value, double min, double max);

// Reads the command line into `values` and into the variables to which `description` is bound. For
// --help, prints the help text and returns false. Throws InputError for an invalid option.
bool ReadToolOptions(const boost::program_options::options_description& description,
                     const std::string& tool, int argc, char** argv,
                     boost::program_options::variables_map* values);

// Runs the tool and returns its exit code: 0, 3 if another program failed, or 2 for any other
// error. Prints the error.
int RunTool(void (*run)(int argc, char** argv), int argc, char** argv);

}  // namespace velamap
