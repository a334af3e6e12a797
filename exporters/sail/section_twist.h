// Twist, relative to the lowest section whose line has its markers at both ends. A line that lacks
// an end has a chord in another direction, by degrees, and the sigmas of its other markers do not
// include this error.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "exporters/sail/section.h"
#include "exporters/sail/section_numbers.h"

namespace velamap {

struct ReferenceSection {
  std::optional<std::size_t> line_idx;  // into PartCurves::lines; nothing without such a section
  std::string name;                     // of its line; empty without one
  bool is_lowest = false;               // of the lines that should have a section

  std::string Text() const;  // "lowest section", "section h2" or "none"
};

// `sections` begins with those of the lines of the part, from the lowest up.
ReferenceSection ChooseReferenceSection(const PartContext& context,
                                        const std::vector<Section>& sections);

// Sets the twists of all sections. `numbers` holds the numbers of each section, those of the lines
// first. `boom` is the azimuth of the boom, or null without one. A twist without a reference is
// left empty.
void SetTwists(const PartContext& context, const std::vector<NumbersWithGradient>& numbers,
               const ReferenceSection& reference, const NumbersWithGradient* boom,
               std::vector<Section>* sections);

// Returns a note on the numbers that refer to a section other than the lowest one, or that are left
// out because there is no reference; empty if neither applies.
std::string ReferenceNote(const ReferenceSection& reference, const std::string& part, bool has_boom,
                          bool has_centerline);

}  // namespace velamap
