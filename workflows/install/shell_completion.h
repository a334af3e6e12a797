// Completion of commands, options and values in bash and zsh, from the table of options.

#pragma once

#include <iosfwd>
#include <vector>

#include "workflows/commands/commands.h"

namespace velamap {

void WriteBashCompletion(const std::vector<Command>& commands, std::ostream& out);
void WriteZshCompletion(const std::vector<Command>& commands, std::ostream& out);

}  // namespace velamap
