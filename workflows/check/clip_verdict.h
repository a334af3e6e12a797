// Judges a clip and says how to improve it.

#pragma once

#include <string>

#include "exporters/report/verdict.h"
#include "workflows/check/clip_facts.h"

namespace velamap {

// Bad: a reconstruction would fail or mislead. Check: it would be less precise than it could be, or
// incomplete. Each reason ends with what to do.
Verdict JudgeClip(const ClipFacts& facts);

// What larger markers would improve, for a clip whose markers are large enough (kBadSidePx), but
// smaller than kGoodSidePx; empty for all others.
std::string SizeHint(const ClipFacts& facts);

}  // namespace velamap
