// Writes what is installed beside the program and made from its table of options: manual pages and
// completions. usage: write_install_files FOLDER
//
// A step of the build, not a command of velamap.

#include <iostream>

#include "importer/base/atomic_output.h"
#include "workflows/install/man_page.h"
#include "workflows/install/shell_completion.h"

namespace velamap {
namespace {

void WriteInstallFiles(const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "velamap.1",
                      [](std::ostream& out) { WriteProgramManPage(CommandGroups(), out); });
  const std::vector<Command> commands = AllCommands();
  for (const Command& command : commands) {
    WriteFileAtomically(folder / ("velamap-" + command.syntax.name + ".1"),
                        [&](std::ostream& out) { WriteManPage(command.syntax, out); });
  }
  WriteFileAtomically(folder / "velamap.bash",
                      [&](std::ostream& out) { WriteBashCompletion(commands, out); });
  WriteFileAtomically(folder / "_velamap",
                      [&](std::ostream& out) { WriteZshCompletion(commands, out); });
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_install_files FOLDER\n";
    return 2;
  }
  try {
    velamap::WriteInstallFiles(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
