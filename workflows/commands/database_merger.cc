#include "importer/database_merger.h"

#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "workflows/commands/commands.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  MarkerOptions markers;
  GeneralOptions general;
  std::string database_paths;
  DatabaseMergerOptions merger;
};

CommandSyntax Declare(Options* options) {
  Option databases = PathOption("database_paths", PathUse::kReadsFiles, &options->database_paths,
                                "databases of all parts, with commas between them, in any order");
  databases.unit = "path,path";
  return {"database_merger",
          "puts the parts of a long video, which marker_importer --part made, into one database",
          "--database_paths part1.db,part2.db,part3.db --layout_path layout.yml \\\n"
          "    --output_path database.db",
          {{"Input and output",
            {Required(databases),
             Required(PathOption("output_path", PathUse::kWritesFile, &options->paths.output_path,
                                 "database, as one import of the whole video makes it; one of "
                                 "velamap that is there is replaced"))}},
           DescribeOptions(&options->markers, true),
           DescribeOptions(&options->general)}};
}

void Validate(Options* options) {
  SetLogLevel(options->general.log_level);
  options->merger.database_paths = PathsInList(options->database_paths);
  options->merger.output_path = options->paths.output_path;
  options->merger.layout = LoadLayout(options->markers, true);
}

void Run(const Options& options) {
  const MergeReport report = MergeDatabases(options.merger);
  fmt::print(std::cout, "parts: {}\n", options.merger.database_paths.size());
  fmt::print(std::cout, "images: {}\n", report.num_images);
  fmt::print(std::cout, "markers: {}\n", report.num_markers);
  fmt::print(std::cout, "pairs_with_matches: {}\n", report.num_pairs);
  fmt::print(std::cout, "database_path: {}\n", options.merger.output_path);
}

}  // namespace

Command DatabaseMerger() {
  return MakeCommand(std::make_shared<Options>(), Declare, Validate, Run);
}

}  // namespace velamap
