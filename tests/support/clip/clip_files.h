// Writes the files beside a rendered clip: the inputs of velamap and the truth.

#pragma once

#include <filesystem>

#include "tests/support/clip/clip_scene.h"

namespace velamap {

// Writes camera.yml (OpenCV FileStorage), layout.yml, its dictionary file if it has one, truth.csv
// (the mean shape), truth_after.csv if the trim changes, and poses.csv (frame, cam_from_world).
void WriteClipFiles(const ClipScene& scene, const std::filesystem::path& folder);

}  // namespace velamap
