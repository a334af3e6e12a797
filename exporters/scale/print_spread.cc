#include "exporters/scale/print_spread.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "exporters/scale/robust_fit.h"

namespace velamap {
namespace {

constexpr double kUmPerM = 1e6;
// Fewer markers do not determine a slope.
constexpr std::size_t kMinMarkers = 8;
// Lowest relative standard deviation of a term over the markers.
constexpr double kMinVariation = 0.05;
// Terms with a higher correlation cannot be separated.
constexpr double kMaxCorrelation = 0.95;

using Vector = Eigen::VectorXd;

double Variation(const Vector& column) {
  const Vector centred = column.array() - column.mean();
  return std::sqrt(centred.squaredNorm() / static_cast<double>(column.size())) /
         std::abs(column.mean());
}

double Correlation(const Vector& a, const Vector& b) {
  const Vector centred_a = a.array() - a.mean(), centred_b = b.array() - b.mean();
  return centred_a.dot(centred_b) / (centred_a.norm() * centred_b.norm());
}

struct Columns {
  Vector values, sigmas, by_print, by_image;
};

Columns ColumnsOf(const std::vector<SpreadSample>& samples) {
  const auto size = static_cast<Eigen::Index>(samples.size());
  Columns columns{Vector(size), Vector(size), Vector(size), Vector::Zero(size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    const SpreadSample& sample = samples[static_cast<std::size_t>(i)];
    columns.values[i] = sample.log_side_ratio;
    columns.sigmas[i] = sample.sigma;
    columns.by_print[i] = 2 / sample.length_m;
    if (sample.side_px) columns.by_image[i] = 2 / *sample.side_px;
  }
  return columns;
}

UncertainValue EstimateOf(const RobustFit& fit, Eigen::Index i, double factor = 1.0) {
  return {factor * fit.coefficients[i], factor * std::sqrt(fit.covariance(i, i))};
}

std::optional<RobustFit> Fit(const Columns& columns, const std::vector<const Vector*>& terms) {
  Eigen::MatrixXd design(columns.values.size(), 1 + terms.size());
  design.col(0).setOnes();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    design.col(static_cast<Eigen::Index>(i) + 1) = *terms[i];
  }
  return FitRobustly(design, columns.values, columns.sigmas);
}

PrintSpread NotDetermined(const std::string& why) {
  PrintSpread spread;
  spread.note = "not determined: " + why;
  return spread;
}

// Both terms vary, but together: the note gives each as it would be without the other.
PrintSpread NoteBothExplanations(const Columns& columns) {
  const auto as_print = Fit(columns, {&columns.by_print});
  const auto as_image = Fit(columns, {&columns.by_image});
  if (!as_print || !as_image) return NotDetermined("too few markers agree");
  const UncertainValue print_um = EstimateOf(*as_print, 1, kUmPerM);
  const UncertainValue image_px = EstimateOf(*as_image, 1);
  return NotDetermined(
      fmt::format("the larger markers are also larger in the images, so {:.3g} +- {:.2g} um in "
                  "the print and {:.3g} +- {:.2g} px in the image explain the sides equally well",
                  print_um.value, print_um.sigma, image_px.value, image_px.sigma));
}

}  // namespace

PrintSpread EstimateSpread(const std::vector<SpreadSample>& samples) {
  if (samples.size() < kMinMarkers) {
    return NotDetermined(fmt::format("{} markers are too few", samples.size()));
  }
  const bool has_images = std::all_of(samples.begin(), samples.end(),
                                      [](const SpreadSample& s) { return s.side_px.has_value(); });
  const Columns columns = ColumnsOf(samples);
  const bool print_varies = Variation(columns.by_print) > kMinVariation;
  const bool image_varies = has_images && Variation(columns.by_image) > kMinVariation;
  if (!print_varies && !image_varies) {
    return NotDetermined(has_images
                             ? "all markers are of one size in the print and in the images"
                             : "all markers are of one size, and no images (a model) are given");
  }
  if (print_varies && image_varies &&
      std::abs(Correlation(columns.by_print, columns.by_image)) > kMaxCorrelation) {
    return NoteBothExplanations(columns);
  }
  std::vector<const Vector*> terms;
  if (print_varies) terms.push_back(&columns.by_print);
  if (image_varies) terms.push_back(&columns.by_image);
  const auto fit = Fit(columns, terms);
  if (!fit) return NotDetermined("too few markers agree");
  PrintSpread spread;
  if (print_varies) spread.print_um = EstimateOf(*fit, 1, kUmPerM);
  if (image_varies) spread.image_px = EstimateOf(*fit, print_varies ? 2 : 1);
  if (print_varies && image_varies) {
    spread.note = "print and image separated";
  } else if (image_varies) {
    spread.note =
        "image only: all markers are printed in one size, so a spread of the print "
        "is part of the scale error";
  } else {
    spread.note = has_images ? "print only: all markers have one size in the images"
                             : "print only: no images (a model) are given";
  }
  return spread;
}

}  // namespace velamap
