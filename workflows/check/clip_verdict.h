// Judges a clip and says how to improve it.

#pragma once

#include "exporters/report/verdict.h"
#include "workflows/check/clip_facts.h"

namespace velamap {

// Bad: a reconstruction would fail or mislead. Check: it would be less precise than it could be, or
// incomplete. Each reason ends with what to do.
Verdict JudgeClip(const ClipFacts& facts);

}  // namespace velamap
