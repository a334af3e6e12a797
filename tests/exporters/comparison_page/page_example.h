// An example of what the page of a comparison shows.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "exporters/comparison_page/comparison_page.h"
#include "tests/exporters/compare/example_comparison.h"

namespace velamap {

ComparisonOptions WithDeflections();

// The depth of the line h3 grows by a tenth.
MarkerShape Fuller();

// Holds what the input refers to.
struct PageExample {
  std::vector<Comparison> series;
  MarkerShape reference = BoatShape(0.001);
  Layout layout = BoatLayout();
  bool is_design = false;

  void Add(const std::string& name, const MarkerShape& shape);
  ComparisonPageInput Input() const;
  nlohmann::json Data() const { return nlohmann::json::parse(ComparisonJson(Input())); }
};

}  // namespace velamap
