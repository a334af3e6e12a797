// Options of the tools that render clips and look at them.

#pragma once

#include <string>

#include <boost/program_options.hpp>

namespace velamap {

// Throws InputError that names the option and the range. Not a number is out of every range.
void CheckOptionRange(const char* option, double value, double min, double max);

// Reads the command line into `values` and into the variables that the description names. Returns
// false after --help, whose text it prints. Throws InputError for a bad option.
bool ReadToolOptions(const boost::program_options::options_description& description,
                     const std::string& tool, int argc, char** argv,
                     boost::program_options::variables_map* values);

// Runs the tool and returns its exit code: 0, 2 for bad input, 3 if another program failed. Prints
// what went wrong.
int RunTool(void (*run)(int argc, char** argv), int argc, char** argv);

}  // namespace velamap
