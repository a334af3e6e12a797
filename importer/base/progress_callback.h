// How a long step reports its progress.

#pragma once

#include <functional>
#include <string>

namespace velamap {

// Called with done = 0 before the first piece of work, and then after each piece. `total` is 0 if
// it is unknown; `message` is a line about the last piece, or empty.
using ProgressCallback = std::function<void(int done, int total, const std::string& message)>;

}  // namespace velamap
