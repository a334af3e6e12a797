// Models without an error, for commands that need no pictures.

#pragma once

#include "reconstruct/model/model.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

// The scene's truth in units of 2 m, every observation exact.
Model TrueModel(const SyntheticScene& scene);

}  // namespace velamap
