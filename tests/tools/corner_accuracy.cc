// corner_accuracy: a table of how well corners of rendered markers are found.

#include <iostream>
#include <vector>

#include <fmt/format.h>
#include <boost/program_options.hpp>

#include "tests/support/study/corner_study.h"
#include "tests/support/tool_options.h"

namespace velamap {
namespace {

namespace po = boost::program_options;

std::vector<CornerCase> SizesAndBlurs(const CornerCase& base) {
  std::vector<CornerCase> cases;
  for (const double blur_px : {0.4, 0.7, 1.0, 1.5}) {
    for (const double side_px : {12.0, 16.0, 20.0, 25.0, 35.0, 50.0, 80.0, 120.0, 200.0}) {
      CornerCase one = base;
      one.blur_px = blur_px;
      one.side_px = side_px;
      cases.push_back(one);
    }
  }
  return cases;
}

std::vector<CornerCase> Hardships(const CornerCase& base) {
  std::vector<CornerCase> cases;
  for (const double side_px : {16.0, 30.0, 65.0}) {
    const auto add = [&](auto change) {
      CornerCase one = base;
      one.side_px = side_px;
      change(&one);
      cases.push_back(one);
    };
    add([](CornerCase* one) { one->noise = 0.0; });
    add([](CornerCase* one) { one->noise = 6.0; });
    add([](CornerCase* one) { one->jpeg_quality = 92; });
    add([](CornerCase* one) { one->jpeg_quality = 75; });
    add([](CornerCase* one) { one->bend_deg = 5; });
    add([](CornerCase* one) { one->bend_deg = 15; });
  }
  for (const double side_px : {40.0, 65.0, 120.0}) {
    CornerCase one = base;
    one.side_px = side_px;
    one.min_tilt_deg = 60;
    one.max_tilt_deg = 70;
    cases.push_back(one);
  }
  return cases;
}

void Print(const std::vector<CornerCase>& cases) {
  std::cout << "| side px | blur px | noise | tilt deg | JPEG | bend deg | failed | side bias px |"
               " std px | bound px | error / sigma | SUBPIX: side bias px | std px |\n"
               "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const CornerCase& one : cases) {
    const CornerAccuracy found = MeasureCorners(one);
    std::cout << fmt::format(
                     "| {:.0f} | {:.1f} | {:.0f} | {:.0f}-{:.0f} | {} | {:.0f} | {}/{} |"
                     " {:+.4f} ± {:.4f} | {:.4f} | {:.4f} | {:.2f} | {:+.3f} | {:.3f} |",
                     one.side_px, one.blur_px, one.noise, one.min_tilt_deg, one.max_tilt_deg,
                     one.jpeg_quality > 0 ? std::to_string(one.jpeg_quality) : "-", one.bend_deg,
                     found.num_failed, found.num_failed + found.num_markers, found.side_bias_px,
                     found.side_bias_sigma_px, found.std_px, found.bound_px, found.error_over_sigma,
                     found.subpix_side_bias_px, found.subpix_std_px)
              << std::endl;
  }
}

void Run(int argc, char** argv) {
  CornerCase base;
  po::options_description description(
      "corner_accuracy [options]\n\nMarkers of DICT_4X4_50, black 40 and white 200, with one cell "
      "of white around them on grey 120; bent\nones on a cylinder. A table in Markdown: each size "
      "and blur, then noise, compression, curvature, tilt",
      100, 60);
  const auto value = [](auto* target) { return po::value(target)->default_value(*target); };
  auto add = description.add_options();
  add("help", "this text");
  add("noise", value(&base.noise), "standard deviation, grey levels");
  add("markers", value(&base.min_markers), "minimum number of markers in a line of the table");
  add("max_tilt", value(&base.max_tilt_deg), "largest tilt of the first lines, degrees");
  add("seed", value(&base.seed), "of the markers' poses and the noise");
  po::variables_map values;
  if (!ReadToolOptions(description, "corner_accuracy", argc, argv, &values)) return;
  Print(SizesAndBlurs(base));
  std::cout << '\n';
  Print(Hardships(base));
}

}  // namespace
}  // namespace velamap

int main(int argc, char** argv) { return velamap::RunTool(velamap::Run, argc, argv); }
