#include "exporters/sail/section_twist.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace velamap {
namespace {

// A number of a section minus the reference's.
Estimate Difference(SectionNumber number, const MarkerCenters& centers,
                    const NumbersWithGradient& own, const NumbersWithGradient& reference) {
  return {own.numbers[number] - reference.numbers[number],
          SigmaOf(number, centers, own, &reference)};
}

// Whether a line below the lowest one with a section has none in this clip. Layouts list the lines
// from foot to head or, like some, from head to foot.
bool LacksLowerLine(const PartContext& context) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  if (lines.size() < 2) return false;  // a single section has no twist relative to another
  const int lowest = lines.front().place_in_layout;
  const bool is_downwards = lines.back().place_in_layout < lowest;
  const std::vector<MarkerLine>& of_layout = context.part.horizontal;
  return std::any_of(
      context.curves.missing.begin(), context.curves.missing.end(), [&](const MissingLine& line) {
        if (line.is_by_layout) return false;
        const auto found =
            std::find_if(of_layout.begin(), of_layout.end(),
                         [&](const MarkerLine& other) { return other.name == line.name; });
        const int place = static_cast<int>(found - of_layout.begin());
        return is_downwards ? place > lowest : place < lowest;
      });
}

}  // namespace

std::string ReferenceSection::Text() const {
  if (!line_idx) return "none";
  return is_lowest ? "lowest section" : "section " + name;
}

ReferenceSection ChooseReferenceSection(const PartContext& context,
                                        const std::vector<Section>& sections) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (sections[i].num_missing_at_luff > 0 || sections[i].num_missing_at_leech > 0) continue;
    return {i, lines[i].name, i == 0 && !LacksLowerLine(context)};
  }
  return {};
}

void SetTwists(const PartContext& context, const std::vector<NumbersWithGradient>& numbers,
               const ReferenceSection& reference, const NumbersWithGradient* boom,
               std::vector<Section>* sections) {
  const NumbersWithGradient* lowest = reference.line_idx ? &numbers[*reference.line_idx] : nullptr;
  const NumbersWithGradient* foot = boom != nullptr ? boom : lowest;
  for (std::size_t i = 0; i < sections->size(); ++i) {
    Section& section = (*sections)[i];
    if (foot != nullptr) {
      section.twist_deg = Difference(kAzimuth, context.centers, numbers[i], *foot);
    }
    if (lowest != nullptr) {
      section.leech_twist_deg = Difference(kLeechAzimuth, context.centers, numbers[i], *lowest);
    }
  }
}

std::string ReferenceNote(const ReferenceSection& reference, const std::string& part, bool has_boom,
                          bool has_centerline) {
  if (reference.is_lowest) return "";
  std::vector<std::string> numbers;
  if (!has_boom) numbers.push_back("twist");
  numbers.push_back("leech twist");
  if (!has_boom && has_centerline) numbers.push_back("sheeting angle");
  if (!has_centerline) numbers.push_back("bend and sag");
  const std::string listed = fmt::format("{}", fmt::join(numbers, ", "));
  if (!reference.line_idx) {
    return fmt::format(
        "no {} of {}: each of its lines lacks markers at the luff or the leech; film both ends of "
        "a low line as well",
        listed, part);
  }
  return fmt::format("{} of {} refer to section {}, the lowest whose line is whole at both ends",
                     listed, part, reference.name);
}

}  // namespace velamap
