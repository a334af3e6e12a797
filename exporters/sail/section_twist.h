// Twist, and the section from which it counts: the lowest one whose line is whole at both ends. The
// chord of a line that lacks an end points elsewhere, by degrees, of which the sigmas of the
// markers that are there know nothing. Private to the sections.

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
  bool is_lowest = false;               // of the lines of which the layout makes sections

  std::string Text() const;  // "lowest section", "section h2" or "none"
};

// `sections` begins with those of the lines of the part, from the lowest up.
ReferenceSection ChooseReferenceSection(const PartContext& context,
                                        const std::vector<Section>& sections);

// Sets the twists of all sections, whose numbers are in `numbers`, from the lines on. `boom` is its
// azimuth, or null without a boom. What lacks a reference gets no twist.
void SetTwists(const PartContext& context, const std::vector<NumbersWithGradient>& numbers,
               const ReferenceSection& reference, const NumbersWithGradient* boom,
               std::vector<Section>* sections);

// Which numbers refer to that section, where it is not the lowest one, or are left out without one;
// empty otherwise.
std::string ReferenceNote(const ReferenceSection& reference, const std::string& part, bool has_boom,
                          bool has_centerline);

}  // namespace velamap
