#include "tests/support/tool_options.h"

#include <iostream>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

namespace po = boost::program_options;

void CheckOptionRange(const char* option, double value, double min, double max) {
  if (value >= min && value <= max) return;
  throw InputError(fmt::format("--{}: {} is out of range; give {} to {}", option, value, min, max));
}

bool ReadToolOptions(const po::options_description& description, const std::string& tool, int argc,
                     char** argv, po::variables_map* values) {
  try {
    po::store(po::parse_command_line(argc, argv, description), *values);
    if (values->count("help") > 0) {
      std::cout << description;
      return false;
    }
    po::notify(*values);
  } catch (const po::error& error) {
    throw InputError(fmt::format("{}; see {} --help", error.what(), tool));
  }
  return true;
}

int RunTool(void (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const ExternalToolError& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 3;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
}

}  // namespace velamap
