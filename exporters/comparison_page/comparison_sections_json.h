// The sections in the JSON of a comparison.

#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "exporters/comparison_page/comparison_page.h"

namespace velamap {

using ComparisonJsonValue = nlohmann::ordered_json;

// Six decimals: a nanometre for values in mm, a micrometre for values in m.
ComparisonJsonValue Rounded(double value);

// Keys numbers and profiles of ComparisonJson().
ComparisonJsonValue NumbersJson(const std::vector<Comparison>& series);
ComparisonJsonValue ProfilesJson(const ComparisonPageInput& input);

}  // namespace velamap
