// The items of a ComparisonVerdict: the figures behind its first line. The other functions serve
// that line as well.

#pragma once

#include <string>
#include <vector>

#include "exporters/comparison_page/comparison_page.h"

namespace velamap {

constexpr double kByChance = 0.0455;  // beyond two sigmas

std::string Capitalized(std::string text);

// Whether all markers agree to a micrometre.
bool IsSame(const ShapeDeviation& deviation);

// The significant differences of section numbers, the most significant first.
std::vector<const SectionDifference*> SignificantOf(const SectionComparison& sections);

std::string DifferenceText(const SectionDifference& d, const std::vector<Comparison>& series);

// Whether some points of the surface differ significantly, and the share of them in words.
bool DiffersSignificantly(const DeflectionField& field);
std::string SurfaceText(const DeflectionField& field);

// Adds the items of one shape, each after `prefix`.
void AddComparisonItems(const std::vector<Comparison>& series, const Comparison& comparison,
                        const std::string& prefix, std::vector<std::string>* items);

}  // namespace velamap
