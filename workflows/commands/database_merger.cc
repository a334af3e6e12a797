#include "importer/database_merger.h"

#include <iostream>

#include <fmt/format.h>

#include "importer/base/replacement.h"
#include "workflows/commands/commands.h"
#include "workflows/options/path_check.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

struct DatabaseMergerCommandOptions : CommandOptions {
  std::string database_paths;
  DatabaseMergerOptions merger;
};

CommandSyntax Declare(DatabaseMergerCommandOptions* options) {
  return {"database_merger",
          "merges the databases of the separately imported parts of a long video into one",
          "--database_paths part1.db,part2.db,part3.db --layout_path layout.yml \\\n"
          "    --output_path database.db",
          {{"Input and output",
            {Required({"database_paths", &options->database_paths, "databases",
                       "databases of all parts, in any order: part1.db,part2.db"}),
             Required(PathOption("output_path", PathUse::kWritesFile, &options->merger.output_path,
                                 "merged database, the same as from one import of the whole video; "
                                 "replaces an earlier database of velamap"))}},
           DescribeOptions(&options->markers, true),
           DescribeOptions(&options->general)}};
}

void Validate(DatabaseMergerCommandOptions* options) {
  options->merger.database_paths =
      PathsFromText(options->database_paths, "--database_paths", "part1.db,part2.db");
  // ParseOptions() checks only options that hold a single path.
  std::vector<UsedPath> inputs;
  for (const std::string& path : options->merger.database_paths) {
    CheckInputKind("--database_paths", path);
    inputs.push_back({"--database_paths", path});
  }
  CheckOutputs(inputs, {{"--output_path", options->merger.output_path}});
  options->merger.layout = LoadLayout(options->markers, true);
}

void Run(const DatabaseMergerCommandOptions& options) {
  const MergeReport report = MergeDatabases(options.merger);
  std::cout << fmt::format("parts: {}\n", options.merger.database_paths.size());
  std::cout << fmt::format("images: {}\n", report.num_images);
  std::cout << fmt::format("markers: {}\n", report.num_markers);
  std::cout << fmt::format("pairs_with_matches: {}\n", report.num_pairs);
  std::cout << fmt::format("database_path: {}\n", options.merger.output_path);
}

}  // namespace

Command DatabaseMerger() {
  return MakeCommand<DatabaseMergerCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
