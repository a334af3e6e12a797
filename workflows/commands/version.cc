#include <iostream>

#include "workflows/commands/commands.h"
#include "workflows/options/option_parser.h"
#include "workflows/run/version.h"
#include "workflows/run/versions.h"

namespace velamap {
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
  std::cout << "velamap: " << kVersion << '\n';
  for (const auto& [name, version] : LibraryVersions(colmap_path)) {
    std::cout << name << ": " << version << '\n';
  }
}

}  // namespace velamap
