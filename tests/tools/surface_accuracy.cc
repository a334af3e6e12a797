// surface_accuracy: how near the surface through markers comes to the sail that they are on, and
// its curvature to the sail's, for sails and noise at random or for a rendered clip.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "exporters/formats/shape_csv.h"
#include "exporters/shape/sail_lines.h"
#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/base/statistics.h"
#include "importer/geometry/alignment.h"
#include "importer/geometry/units.h"
#include "importer/layout/layout.h"
#include "tests/support/study/sail_study.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

struct Study {
  std::string name;
  double marker_error_mm = 0.0;  // root mean square along the normal
  int num_draws = 0;
  // By place; the errors of the surface in markers' errors.
  std::vector<double> squared_errors;
  std::vector<double> curvature_errors;  // inside, 1/m
};

// `sigma_m_at` gives the sigma of a marker at a fraction of its line.
template <typename Sigma>
void AddErrors(const std::vector<SurfaceError>& errors, const Sigma& sigma_m_at, Study* study) {
  study->squared_errors.resize(errors.size());
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double in_sigmas = errors[k].distance_m / sigma_m_at(errors[k].along);
    study->squared_errors[k] += in_sigmas * in_sigmas;
    if (!errors[k].is_inside) continue;
    study->curvature_errors.push_back(std::abs(errors[k].found_curvature - errors[k].curvature));
  }
  ++study->num_draws;
}

void PrintHeader() {
  std::cout
      << "series,marker_error_mm,num_draws,error_ratio_rms,places_below_1_2_percent,"
         "error_ratio_max,curvature_error_rms,curvature_error_median,curvature_error_95_percent,"
         "curvature_within_0_05_percent,curvature_error_max\n";
}

void Print(Study study) {
  double sum = 0.0, worst = 0.0;
  int num_below = 0;
  for (const double squares : study.squared_errors) {
    const double ratio = std::sqrt(squares / study.num_draws);
    sum += squares / study.num_draws;
    worst = std::max(worst, ratio);
    num_below += ratio <= 1.2 ? 1 : 0;
  }
  std::vector<double>& curvatures = study.curvature_errors;
  std::sort(curvatures.begin(), curvatures.end());
  const double num_places = static_cast<double>(study.squared_errors.size());
  const auto num_within = std::upper_bound(curvatures.begin(), curvatures.end(), 0.05);
  std::cout << fmt::format(
                   "{},{},{},{:.3f},{:.1f},{:.3f},{:.4f},{:.4f},{:.4f},{:.1f},{:.4f}", study.name,
                   study.marker_error_mm, study.num_draws, std::sqrt(sum / num_places),
                   100 * num_below / num_places, worst, ComputeStatistics(curvatures).rms,
                   Median(curvatures), curvatures[curvatures.size() * 95 / 100],
                   100.0 * (num_within - curvatures.begin()) / curvatures.size(), curvatures.back())
            << std::endl;
}

void PrintDraws(const std::vector<double>& sigmas_mm, int num_draws, unsigned seed) {
  PrintHeader();
  for (const double sigma_mm : sigmas_mm) {
    const double sigma_m = sigma_mm / kMmPerM;
    const auto sigma_m_at = [&](double along) { return MarkerSigma(sigma_m, along); };
    Study study{"random", sigma_mm, 0, {}, {}};
    for (int draw = 0; draw < num_draws; ++draw) {
      std::mt19937 random(seed + static_cast<unsigned>(draw));
      const Surface sail = DrawSail(&random);
      const SailLines lines = DrawLines(sail, &random);
      const SurfaceInput input = DrawMarkers(sail, lines, sigma_m, &random);
      AddErrors(MeasureSurface(FitSurface(input).surface, sail, lines), sigma_m_at, &study);
    }
    Print(study);
  }
}

struct ClipPaths {
  std::string name = "clip", shape, layout, reference;
};

// Lines of the rendered sail: its luff is at x = 0 and its u is known from the chord.
SailLines LinesOf(const MarkerShape& truth, const LayoutPart& part, const Surface& sail) {
  SailLines lines;
  for (const MarkerLine& line : part.horizontal) {
    const Eigen::Vector3d first = CenterOf(truth, line.marker_ids.front());
    const Eigen::Vector3d last = CenterOf(truth, line.marker_ids.back());
    const double foot_m = sail({0, 0}).z(), height_m = sail({0, 1}).z() - foot_m;
    const double v = (first.z() - foot_m) / height_m;
    const Eigen::Vector3d luff = sail({0, v}), chord = sail({1, v}) - luff;
    lines.vs.push_back(v);
    lines.first_us.push_back(chord.dot(first - luff) / chord.squaredNorm());
    lines.last_us.push_back(chord.dot(last - luff) / chord.squaredNorm());
  }
  return lines;
}

SurfaceInput InFrameOf(const Rigid3& sail_from_shape, SurfaceInput input) {
  const auto move = [&](SurfaceMarker* marker) {
    marker->x_in_shape_m = sail_from_shape * marker->x_in_shape_m;
    for (Eigen::Vector3d& corner : marker->corners_in_shape_m) corner = sail_from_shape * corner;
  };
  for (SurfaceLine& line : input.lines) {
    for (auto& marker : line.markers) {
      if (marker) move(&*marker);
    }
  }
  for (SurfaceMarker& marker : input.markers) move(&marker);
  return input;
}

// The markers' own errors are their distances from the sail; one place has one error here, so that
// the ratio is that of root mean squares over all places.
void PrintClip(const ClipPaths& paths, bool with_profiles) {
  const Layout layout = ReadLayout(paths.layout);
  const LayoutPart* part = FirstPartWithLines(layout);
  if (part == nullptr) throw InputError(paths.layout + ": no horizontal lines");
  const MarkerShape shape = ReadShapeCsv(paths.shape), truth = ReadShapeCsv(paths.reference);
  std::vector<Eigen::Vector3d> found_m, true_m;
  for (const ShapeMarker& marker : truth.markers) {
    if (marker.part != part->name || FindWholeMarker(shape, marker.marker_id) == nullptr) continue;
    found_m.push_back(CenterOf(shape, marker.marker_id));
    true_m.push_back(CenterOf(truth, marker.marker_id));
  }
  const Rigid3 sail_from_shape = EstimateRigid3(found_m, true_m);
  const SurfaceInput input = InFrameOf(sail_from_shape, CollectSurfaceInput(shape, *part));
  const SplineSurface surface = FitSurface(input).surface;
  const Surface sail = MakeSail({1.0, 0.10, 15 * kRadPerDeg});  // as render_clip's
  const std::vector<SurfaceError> errors =
      MeasureSurface(surface, sail, LinesOf(truth, *part, sail));
  if (with_profiles) {
    std::cout << "height_m,along,curvature,found_curvature,error_mm\n";
    for (const SurfaceError& error : errors) {
      std::cout << fmt::format("{:.3f},{:.3f},{:.4f},{:.4f},{:.4f}\n", error.x_in_sail_m.z(),
                               error.along, error.curvature, error.found_curvature,
                               kMmPerM * error.distance_m);
    }
    return;
  }
  std::vector<double> marker_errors_m, surface_errors_m;
  for (std::size_t k = 0; k < found_m.size(); ++k) {
    const SurfaceFoot foot = ProjectOnSurface(surface, {true_m[k]}).front();
    const Eigen::Vector3d normal = EvaluateJet(surface, foot.u, foot.v).normal;
    marker_errors_m.push_back(normal.dot(sail_from_shape * found_m[k] - true_m[k]));
  }
  const double marker_rms_m = ComputeStatistics(marker_errors_m).rms;
  Study study{paths.name, std::round(1e4 * kMmPerM * marker_rms_m) / 1e4, 0, {}, {}};
  AddErrors(
      errors, [&](double) { return marker_rms_m; }, &study);
  PrintHeader();
  Print(study);
}

void Run(int argc, char** argv) {
  int num_draws = 40;
  unsigned seed = 1;
  std::string sigmas = "0.1,0.3,1,3";
  ClipPaths clip;
  po::options_description description("surface_accuracy [options]", 100, 60);
  const auto value = [](auto* target) { return po::value(target)->default_value(*target); };
  auto add = description.add_options();
  add("help", "this text");
  add("num_draws", value(&num_draws), "sails for each noise");
  add("seed", value(&seed), "of the first sail");
  add("sigmas", value(&sigmas), "mm, of the markers in the middle of the lines");
  add("name", value(&clip.name), "of a clip, in the table");
  add("shape_path", value(&clip.shape), "shape.csv from a rendered clip, instead of random sails");
  add("layout_path", value(&clip.layout), "its layout");
  add("reference_path", value(&clip.reference), "its truth");
  add("profiles", "the curvature at every place of the clip instead of the table's row");
  po::variables_map values;
  if (!ReadToolOptions(description, "surface_accuracy", argc, argv, &values)) return;
  if (!clip.shape.empty()) {
    PrintClip(clip, values.count("profiles") > 0);
    return;
  }
  CheckOptionRange("num_draws", num_draws, 1, 100000);
  const auto sigmas_mm = ParseNumberList<double>(sigmas);
  if (!sigmas_mm) throw InputError("--sigmas: expected numbers of mm such as 0.3,1,3");
  PrintDraws(*sigmas_mm, num_draws, seed);
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::RunTool(velamap::Run, argc, argv); }
