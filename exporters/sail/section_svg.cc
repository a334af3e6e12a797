// SVG function of section_drawing.h.

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "exporters/sail/section_drawing.h"
#include "exporters/sail/section_writer.h"
#include "importer/geometry/units.h"
#include "importer/text/markup.h"
#include "importer/text/number_text.h"

namespace velamap {
namespace {

constexpr double kMargin = 24, kDrawingWidth = 640, kNumbersWidth = 300;
constexpr double kWidth = 3 * kMargin + kDrawingWidth + kNumbersWidth;
constexpr double kLine = 15;            // height of a line of text
constexpr int kNumberLines = 4;         // beside a profile
constexpr std::size_t kMaxChars = 150;  // per line of text below the profiles

void WriteText(double x, double y, const std::string& style, const std::string& text,
               std::ostream& out) {
  out << fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>\n", x, y, style,
                     EscapeForMarkup(text));
}

std::string WithSigma(const Estimate& estimate, double factor, int digits) {
  return UncertainText(estimate.value, estimate.sigma, factor, digits, "±");
}

std::string TwistText(const std::optional<Estimate>& twist_deg) {
  if (!twist_deg) return "no twist";
  if (twist_deg->value == 0 && twist_deg->sigma.value_or(0) == 0) return "reference of the twist";
  return fmt::format("twist {}°", WithSigma(*twist_deg, 1, 2));
}

std::vector<std::string> NumbersText(const Section& section) {
  const std::string draft =
      section.draft_position ? WithSigma(*section.draft_position, 100, 1) + " %" : "none";
  return {
      fmt::format("chord {} mm at {} mm", WithSigma(section.chord_m, kMmPerM, 1),
                  FixedText(kMmPerM * section.height_m, 0)),
      fmt::format("camber {} %, draft {}", WithSigma(section.camber, 100, 2), draft),
      fmt::format("entry {}°, exit {}°", WithSigma(section.entry_angle_deg, 1, 1),
                  WithSigma(section.exit_angle_deg, 1, 1)),
      TwistText(section.twist_deg),
  };
}

// Breaks the text at spaces; words longer than a line are kept.
std::vector<std::string> Wrapped(std::string text) {
  constexpr std::size_t kMinChars = 40;
  std::vector<std::string> lines;
  while (text.size() > kMaxChars) {
    const std::size_t space = text.rfind(' ', kMaxChars);
    if (space == std::string::npos || space < kMinChars) break;
    lines.push_back(text.substr(0, space));
    text = "  " + text.substr(space + 1);
  }
  lines.push_back(text);
  return lines;
}

// Largest depths above and below the chord, mm.
struct Range {
  double above = 0.0, below = 0.0;
};

Range DepthRange(const Section& section) {
  Range range;
  const auto add = [&](const ProfilePoint& point) {
    range.above = std::max(range.above, kMmPerM * point.depth_m);
    range.below = std::max(range.below, -kMmPerM * point.depth_m);
  };
  for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) add(point);
  for (const SectionMarker& marker : section.markers) {
    add(ProfilePointOf(section, marker.x_in_frame_m));
  }
  return range;
}

void WriteProfile(const Section& section, double px_per_mm, double chord_y, std::ostream& out) {
  const auto x = [&](double chordwise_m) { return kMargin + px_per_mm * kMmPerM * chordwise_m; };
  const auto y = [&](double depth_m) { return chord_y - px_per_mm * kMmPerM * depth_m; };
  const double chord_m = section.chord_m.value;
  out << fmt::format(
      "<line class=\"chord\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", x(0),
      y(0), x(chord_m), y(0));
  if (section.draft_position) {
    const double place = x(section.draft_position->value * chord_m);
    out << fmt::format(
        "<line class=\"depth\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", place,
        y(0), place, y(section.camber.value * chord_m));
  }
  out << "<polyline class=\"curve\" points=\"";
  for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
    out << fmt::format("{:.2f},{:.2f} ", x(point.chordwise_m), y(point.depth_m));
  }
  out << "\"/>\n";
  for (const SectionMarker& marker : section.markers) {
    const ProfilePoint point = ProfilePointOf(section, marker.x_in_frame_m);
    out << fmt::format(
        "<circle class=\"marker\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2\"><title>marker {}, residual "
        "{:.2f} mm</title></circle>\n",
        x(point.chordwise_m), y(point.depth_m), marker.marker_id, kMmPerM * marker.residual_m);
  }
}

void WriteScaleBar(double px_per_mm, double y, std::ostream& out) {
  // 1, 2 or 5 times a power of ten, up to a quarter of the width.
  const double quarter_mm = kDrawingWidth / 4 / px_per_mm;
  double length_mm = std::pow(10.0, std::floor(std::log10(quarter_mm)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * length_mm <= quarter_mm) {
      length_mm *= factor;
      break;
    }
  }
  const double end = kMargin + px_per_mm * length_mm;
  out << fmt::format("<path class=\"bar\" d=\"M{0:.2f} {1:.2f}v6h{2:.2f}v-6\"/>\n", kMargin, y - 6,
                     end - kMargin);
  WriteText(end + 8, y, "small",
            fmt::format("{:.6g} mm; unit mm, luff left, leeward up", length_mm), out);
}

std::vector<std::string> FootLines(const SectionReport& report, const ShapeFrame& frame) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& text) {
    for (const std::string& line : Wrapped(text)) lines.push_back(line);
  };
  add("frame " + FrameText(frame));
  for (const RigNumbers& rig : report.rigs) {
    if (rig.twist_reference == "none") continue;  // a note says why
    add(fmt::format("twist of {} against {}", rig.part, rig.twist_reference));
  }
  if (!report.rigs.empty()) add("± is one standard deviation");
  for (const std::string& note : report.notes) add(note);
  for (const MissingSection& missing : report.missing) {
    add(fmt::format("{} {} left out: {}", missing.part, missing.name, missing.reason));
  }
  return lines;
}

}  // namespace

void WriteSectionProfilesSvg(const SectionReport& report, const ShapeFrame& frame,
                             std::ostream& out) {
  double longest_mm = 1.0;
  std::vector<Range> ranges;
  for (const Section& section : report.sections) {
    longest_mm = std::max(longest_mm, kMmPerM * section.chord_m.value);
    ranges.push_back(DepthRange(section));
  }
  const double px_per_mm = kDrawingWidth / longest_mm;
  // Lays out the profiles first, because the drawing starts with its size.
  std::vector<double> chord_ys(ranges.size());
  double y = kMargin;
  for (std::size_t i = ranges.size(); i-- > 0;) {  // from the head down
    const double above = px_per_mm * ranges[i].above + kLine;
    const double below = px_per_mm * ranges[i].below + kLine;
    chord_ys[i] = y + above;
    y += std::max(above + below, (kNumberLines + 1) * kLine) + kLine / 2;
  }
  const std::vector<std::string> foot = FootLines(report, frame);
  const double bar_y = y + kLine;
  const double height = bar_y + kLine * static_cast<double>(foot.size() + 1) + kMargin;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      << fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n",
             kWidth, height)
      << "<title>Sections</title>\n"
      << "<style>text{font:12px sans-serif;fill:#222}.name{font-weight:bold}.small{font-size:10px;"
         "fill:#555}.chord{stroke:#999}.depth{stroke:#999;stroke-dasharray:3 3}"
         ".curve{fill:none;stroke:#0b5394;stroke-width:1.5}.marker{fill:#c00}"
         ".bar{fill:none;stroke:#222}</style>\n"
      << fmt::format("<rect width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#fff\"/>\n", kWidth, height);
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    WriteProfile(section, px_per_mm, chord_ys[i], out);
    const double top = chord_ys[i] - px_per_mm * ranges[i].above;
    const double left = 2 * kMargin + kDrawingWidth;
    WriteText(left, top, "name", section.part + " " + section.name, out);
    const std::vector<std::string> lines = NumbersText(section);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      WriteText(left, top + kLine * static_cast<double>(k + 1), "numbers", lines[k], out);
    }
  }
  if (!report.sections.empty()) WriteScaleBar(px_per_mm, bar_y, out);
  for (std::size_t k = 0; k < foot.size(); ++k) {
    WriteText(kMargin, bar_y + kLine * static_cast<double>(k + 1) + 6, "small", foot[k], out);
  }
  out << "</svg>\n";
}

}  // namespace velamap
