// The commands of the program. Each reads its options, calls the rooms' doors and prints its
// results as `key: value` on stdout; errors leave it as exceptions (importer/base/error.h).

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace velamap {

using Arguments = std::vector<std::string>;

void RunAutomaticReconstructor(const Arguments& arguments);
void RunMarkerImporter(const Arguments& arguments);
void RunFrameRegistrator(const Arguments& arguments);
void RunBundleAdjuster(const Arguments& arguments);
void RunCentralFrameSweeper(const Arguments& arguments);
void RunShapeExporter(const Arguments& arguments);
void RunShapeAnalyzer(const Arguments& arguments);
void RunShapeComparer(const Arguments& arguments);
void RunHelp(const Arguments& arguments);
void RunVersion(const Arguments& arguments);

struct Command {
  const char* name;
  void (*run)(const Arguments&);
  const char* description;  // one line
};

// The registry: what is not in it does not exist.
const std::vector<Command>& Commands();

// Throws InputError, naming the nearest command, for an unknown one.
const Command& FindCommand(const std::string& name);

}  // namespace velamap
