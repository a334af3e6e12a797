#include <iostream>

#include "importer/error.h"
#include "reconstruct/colmap_runner.h"
#include "workflows/commands.h"
#include "workflows/option_parser.h"
#include "workflows/version.h"

namespace velamap {
namespace {

// First line of COLMAP's help, such as `COLMAP 3.8 -- Structure-from-Motion and ...`.
std::string ColmapVersion(const std::string& colmap_path) {
  try {
    const std::string output = RunColmap(colmap_path, {"help"}, "/dev/null").output;
    return output.substr(0, output.find_first_of("-\n("));
  } catch (const ExternalToolError&) {
    // Not having COLMAP is an answer here, not a failure.
    return "not found (" + colmap_path + ")";
  }
}

}  // namespace

void RunVersion(const Arguments& arguments) {
  std::string colmap_path = "colmap";
  const CommandSyntax syntax{
      "version",
      "versions of velamap and of what it works with",
      "--colmap_path /usr/bin/colmap",
      {{"Options", {{"colmap_path", &colmap_path, "path", "COLMAP's program"}}}}};
  if (!ParseOptions(syntax, arguments, {})) {
    PrintHelp(syntax, std::cout);
    return;
  }
  std::cout << "velamap: " << kVersion << "\nopencv: " << kOpenCvVersion
            << "\neigen: " << kEigenVersion << "\ncolmap: " << ColmapVersion(colmap_path) << '\n';
}

}  // namespace velamap
