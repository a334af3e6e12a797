#include <iostream>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "workflows/commands/commands.h"

namespace velamap {

void RunHelp(const Arguments& arguments) {
  if (!arguments.empty()) {
    FindCommand(arguments.front()).run({"--help"});
    return;
  }
  std::cout << "velamap: metric 3D shape from pictures of coded markers, through COLMAP\n\n"
               "Usage:\n"
               "  velamap COMMAND --option value ...\n"
               "  velamap COMMAND --help\n\n"
               "Commands:\n";
  for (const Command& command : Commands()) {
    fmt::print(std::cout, "  {:<25}{}\n", command.name, command.description);
  }
  std::cout << "\nExample:\n"
               "  velamap automatic_reconstructor --image_path photos --camera_path camera.yml \\\n"
               "    --layout_path layout.yml --workspace_path result\n";
}

}  // namespace velamap
