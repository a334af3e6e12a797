// freeform_accuracy: how near the surface through markers on no lines comes to the body that they
// are on, for our method and for those of libraries, over markers and noise at random.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "exporters/freeform/freeform_surface.h"
#include "importer/geometry/units.h"
#include "tests/exporters/freeform/random_markers.h"
#include "tests/support/tool_options.h"
#include "tests/tools/filling_methods.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

// A body with the markers that are drawn on it.
struct Body {
  std::string name;
  bool is_graph = true;  // above a plane
  TrueSurface truth;
  RandomMarkers random;
};

// The part of a surface within 60 degrees of its middle.
TrueSurface CapOfSphere(double radius_m) {
  TrueSurface surface = Sphere(radius_m);
  const auto whole = surface.point;
  surface.point = [whole](double u, double v) { return whole(u, 0.75 + 0.25 * v); };
  return surface;
}

TrueSurface StripOfCylinder(double radius_m, double length_m) {
  TrueSurface surface = Cylinder(radius_m, length_m);
  const auto whole = surface.point;
  surface.point = [whole](double u, double v) { return whole(u / 3, v); };
  return surface;
}

std::vector<Body> Bodies() {
  return {{"part of a sphere", true, CapOfSphere(0.5), {0.12, 0.05, 2e-4}},
          {"part of a cylinder", true, StripOfCylinder(0.5, 1.2), {0.15, 0.05, 2e-4}},
          {"saddle", true, Saddle(0.4, 0.7), {0.15, 0.05, 3e-4}},
          {"wave", true, Wave(0.06, 0.6), {0.12, 0.04, 2e-4}},
          {"sphere", false, Sphere(0.5), {0.2, 0.05, 2e-4}},
          {"cylinder", false, Cylinder(0.3, 1.2), {0.2, 0.05, 2e-4}},
          {"torus", false, Torus(0.6, 0.2), {0.15, 0.05, 2e-4}}};
}

std::vector<FillingMethod> LibraryMethods() {
  std::vector<FillingMethod> methods;
  AddOpenCascadeMethods(&methods);
#ifdef VELAMAP_WITH_CGAL
  AddCgalMethods(&methods);
#endif
  return methods;
}

struct Result {
  double sum_m2 = 0.0, largest_m = 0.0, sum_sigmas2 = 0.0, seconds = 0.0;
  int num_places = 0, num_lacking = 0, num_draws = 0;

  void Add(double error_m) {
    sum_m2 += error_m * error_m;
    largest_m = std::max(largest_m, std::abs(error_m));
    ++num_places;
  }
};

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::set<int> OpenVertices(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> open;
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      if (open.erase({to, from}) == 0) open.insert({from, to});
    }
  }
  std::set<int> vertices;
  for (const auto& [from, to] : open) vertices.insert({from, to});
  return vertices;
}

void Measure(const Body& body, std::mt19937* generator, std::map<std::string, Result>* results) {
  const std::vector<FreeformMarker> markers = DrawMarkers(body.truth, body.random, generator);
  double start_s = CpuSeconds();
  const FreeformSurface surface = FitFreeformSurface(markers, body.random.side_m, std::nullopt, 1);
  Result& ours = (*results)["velamap"];
  ours.seconds += CpuSeconds() - start_s;
  ++ours.num_draws;
  const TriangleMesh& mesh = surface.mesh;
  const std::set<int> open = OpenVertices(mesh);
  std::vector<bool> is_given;
  std::vector<Eigen::Vector3d> places_m, normals;
  for (std::size_t i = 0; i < mesh.vertices_m.size(); ++i) {
    const Eigen::Vector3d& x = mesh.vertices_m[i];
    is_given.push_back(i < kNumCorners * markers.size() || open.count(static_cast<int>(i)) > 0);
    if (is_given.back()) continue;
    normals.push_back(TrueNormal(body.truth, x));
    places_m.push_back(x - body.truth.distance_m(x) * normals.back());
    const double error_m = body.truth.distance_m(x);
    ours.Add(error_m);
    ours.sum_sigmas2 += std::pow(error_m / mesh.sigmas_m[i], 2);
  }
  for (const FillingMethod& method : LibraryMethods()) {
    if (!method.can_close && !body.is_graph) continue;
    start_s = CpuSeconds();
    const auto offsets_m = method.offsets_m({markers, mesh, is_given, places_m, normals});
    Result& result = (*results)[method.name];
    result.seconds += CpuSeconds() - start_s;
    ++result.num_draws;
    for (const auto& offset_m : offsets_m) {
      offset_m ? result.Add(*offset_m) : static_cast<void>(++result.num_lacking);
    }
  }
}

void Run(int argc, char** argv) {
  int num_draws = 10;
  unsigned seed = 1;
  po::options_description description("freeform_accuracy [options]", 100, 60);
  const auto value = [](auto* target) { return po::value(target)->default_value(*target); };
  auto add = description.add_options();
  add("help", "this text");
  add("num_draws", value(&num_draws), "sets of markers for each body");
  add("seed", value(&seed), "of the first set");
  po::variables_map values;
  if (!ReadToolOptions(description, "freeform_accuracy", argc, argv, &values)) return;
  CheckOptionRange("num_draws", num_draws, 1, 100000);
  std::cout << "body,noise_mm,method,num_draws,rms_mm,largest_mm,error_in_sigmas,lacking_percent,"
               "cpu_s\n";
  for (const Body& body : Bodies()) {
    std::map<std::string, Result> results;
    for (int draw = 0; draw < num_draws; ++draw) {
      std::mt19937 generator(seed + static_cast<unsigned>(draw));
      Measure(body, &generator, &results);
    }
    std::vector<std::string> names = {"velamap"};
    for (const FillingMethod& method : LibraryMethods()) names.push_back(method.name);
    for (const std::string& name : names) {
      const Result& result = results[name];
      if (result.num_places == 0) continue;
      const std::string sigmas =
          result.sum_sigmas2 > 0
              ? fmt::format("{:.3f}", std::sqrt(result.sum_sigmas2 / result.num_places))
              : "";
      std::cout << fmt::format(
                       "{},{:.1f},{},{},{:.4f},{:.3f},{},{:.2f},{:.3f}", body.name,
                       kMmPerM * body.random.sigma_m, name, result.num_draws,
                       kMmPerM * std::sqrt(result.sum_m2 / result.num_places),
                       kMmPerM * result.largest_m, sigmas,
                       100.0 * result.num_lacking / (result.num_places + result.num_lacking),
                       result.seconds / result.num_draws)
                << std::endl;
    }
  }
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::RunTool(velamap::Run, argc, argv); }
