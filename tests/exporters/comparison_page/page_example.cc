#include "tests/exporters/comparison_page/page_example.h"

namespace velamap {

ComparisonOptions WithDeflections() {
  ComparisonOptions options;
  options.with_deflections = true;
  return options;
}

MarkerShape Fuller() {
  MarkerShape shape = BoatShape(0.001);
  const MarkerShape boat = shape;
  for (const int id : {32, 33, 34, 35}) {
    const double u = 0.2 * (id - 31);
    shape = Shifted({id}, -0.12 * u * (1 - u) * MarkerNormal(*FindWholeMarker(boat, id)), shape);
  }
  return shape;
}

void PageExample::Add(const std::string& name, const MarkerShape& shape) {
  series.push_back(
      Compare(name, WithSigmas(shape), WithSigmas(reference), layout, WithDeflections()));
}

ComparisonPageInput PageExample::Input() const {
  ComparisonPageInput input{series, is_design ? nullptr : &reference, layout};
  input.reference_name = is_design ? "design.step" : "trim1";
  input.version = "0.0";
  return input;
}

}  // namespace velamap
