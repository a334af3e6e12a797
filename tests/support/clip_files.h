// The files that stand beside a rendered clip: what velamap is told, and the truth.

#pragma once

#include <filesystem>
#include <iosfwd>

#include "tests/support/clip_scene.h"

namespace velamap {

// camera.yml (OpenCV FileStorage), layout.yml with its dictionary file if any, truth.csv (the
// mean shape; where the trim changes also truth_after.csv) and poses.csv (frame, cam_from_world).
void WriteClipFiles(const ClipScene& scene, const std::filesystem::path& folder);

void WriteLayout(const Layout& layout, std::ostream& out);

}  // namespace velamap
