// The sample's stylus, reconstructed once for all tests that look at a result.

#pragma once

#include <filesystem>

namespace velamap {

// The workspace that automatic_reconstructor makes of the photographs with its default options.
// Tests share it: one that changes it takes a copy. ctest's test stylus.workspace makes it; a test
// started by hand makes one of its own. Throws std::runtime_error if that fails.
const std::filesystem::path& StylusWorkspace();

void CopyStylusWorkspace(const std::filesystem::path& workspace_path);

}  // namespace velamap
