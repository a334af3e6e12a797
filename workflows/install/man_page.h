// Manual pages (man, section 1) from the table of options.

#pragma once

#include <iosfwd>
#include <vector>

#include "workflows/commands/commands.h"

namespace velamap {

// The page velamap-COMMAND, with all options.
void WriteManPage(const CommandSyntax& syntax, std::ostream& out);

// The page velamap, which lists the commands.
void WriteProgramManPage(const std::vector<CommandGroup>& groups, std::ostream& out);

}  // namespace velamap
