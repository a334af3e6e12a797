// DXF functions of section_drawing.h. A DXF file consists of pairs of lines: a group code and its
// value.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/formats/ascii.h"
#include "exporters/sail/section_drawing.h"
#include "exporters/sail/section_writer.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

constexpr double kGapPerDepth = 0.5;  // gap between profiles over the largest depth
constexpr double kMinGap_mm = 100.0;

struct DxfOutput {
  std::ostream& stream;
  LengthUnit unit;

  // All functions take lengths in mm; WritePoint() and WriteText() convert them to `unit`.
  double UnitsPerMm() const { return kMPerMm * UnitsPerM(unit); }
};

void Write(const DxfOutput& out, int code, const std::string& value) {
  out.stream << fmt::format("{:>3}\n{}\n", code, value);
}
void Write(const DxfOutput& out, int code, int value) { Write(out, code, std::to_string(value)); }

void WritePoint(const DxfOutput& out, const Eigen::Vector3d& x_mm) {
  // Rounds to 0.0001 mm; adding 0 turns -0 into 0.
  const int digits = out.unit == LengthUnit::kMetre ? 7 : 4;
  for (int axis = 0; axis < 3; ++axis) {
    const double rounded_mm = std::round(x_mm[axis] * 1e4) / 1e4 + 0.0;
    Write(out, 10 * (axis + 1), fmt::format("{:.{}f}", out.UnitsPerMm() * rounded_mm, digits));
  }
}

constexpr std::size_t kMaxLayerName = 31;  // of R12

// R12 allows capital letters, digits, $, - and _.
std::string LayerName(const std::string& name) {
  std::string layer;
  for (const char character : name) {
    const auto c = static_cast<unsigned char>(character);
    const bool is_allowed = c < 128 && (std::isalnum(c) || c == '-' || c == '$');
    layer += is_allowed ? static_cast<char>(std::toupper(c)) : '_';
  }
  return layer.substr(0, kMaxLayerName);
}

// One unique layer name per section.
std::vector<std::string> SectionLayers(const SectionReport& report) {
  std::vector<std::string> layers;
  std::set<std::string> used = {"MARKERS", "CHORDS", "NAMES"};
  for (const Section& section : report.sections) {
    const std::string name = LayerName(section.part + "_" + section.name);
    std::string layer = name;
    for (int i = 2; !used.insert(layer).second; ++i) {
      const std::string suffix = fmt::format("_{}", i);
      layer = name.substr(0, kMaxLayerName - suffix.size()) + suffix;
    }
    layers.push_back(layer);
  }
  return layers;
}

void WriteHeader(const ShapeFrame& frame, const std::vector<std::string>& layers,
                 const Eigen::AlignedBox3d& extent_mm, const DxfOutput& out) {
  Write(out, 999,
        fmt::format("velamap sections, unit {}, frame {}", ChoiceName(kLengthUnits, out.unit),
                    Ascii(SingleLine(FrameText(frame)))));
  Write(out, 0, "SECTION");
  Write(out, 2, "HEADER");
  Write(out, 9, "$ACADVER");
  Write(out, 1, "AC1009");
  Write(out, 9, "$INSUNITS");
  Write(out, 70, out.unit == LengthUnit::kMetre ? 6 : 4);  // codes of m and mm
  if (!extent_mm.isEmpty()) {
    Write(out, 9, "$EXTMIN");
    WritePoint(out, extent_mm.min());
    Write(out, 9, "$EXTMAX");
    WritePoint(out, extent_mm.max());
  }
  Write(out, 0, "ENDSEC");
  Write(out, 0, "SECTION");
  Write(out, 2, "TABLES");
  Write(out, 0, "TABLE");
  Write(out, 2, "LAYER");
  Write(out, 70, static_cast<int>(layers.size()));
  for (const std::string& layer : layers) {
    Write(out, 0, "LAYER");
    Write(out, 2, layer);
    Write(out, 70, 0);
    Write(out, 62, 7);  // black or white
    Write(out, 6, "CONTINUOUS");
  }
  Write(out, 0, "ENDTAB");
  Write(out, 0, "ENDSEC");
  Write(out, 0, "SECTION");
  Write(out, 2, "ENTITIES");
}

void WriteEnd(const DxfOutput& out) {
  Write(out, 0, "ENDSEC");
  Write(out, 0, "EOF");
}

void WritePolyline(const std::vector<Eigen::Vector3d>& points_mm, const std::string& layer,
                   const DxfOutput& out) {
  Write(out, 0, "POLYLINE");
  Write(out, 8, layer);
  Write(out, 66, 1);  // vertices follow
  WritePoint(out, Eigen::Vector3d::Zero());
  Write(out, 70, 8);  // 3D
  for (const Eigen::Vector3d& x_mm : points_mm) {
    Write(out, 0, "VERTEX");
    Write(out, 8, layer);
    WritePoint(out, x_mm);
    Write(out, 70, 32);  // of a 3D polyline
  }
  Write(out, 0, "SEQEND");
  Write(out, 8, layer);
}

void WriteMarkerPoint(const Eigen::Vector3d& x_mm, const DxfOutput& out) {
  Write(out, 0, "POINT");
  Write(out, 8, "MARKERS");
  WritePoint(out, x_mm);
}

void WriteText(const Eigen::Vector3d& x_mm, const std::string& text, const DxfOutput& out) {
  Write(out, 0, "TEXT");
  Write(out, 8, "NAMES");
  WritePoint(out, x_mm);
  constexpr double kHeight_mm = 40;
  Write(out, 40, fmt::format("{}", out.UnitsPerMm() * kHeight_mm));
  Write(out, 1, Ascii(SingleLine(text)));
}

Eigen::Vector3d FlatPoint(const ProfilePoint& point, double base_mm) {
  return {kMmPerM * point.chordwise_m, base_mm + kMmPerM * point.depth_m, 0};
}

}  // namespace

void WriteSectionsDxf(const SectionReport& report, const ShapeFrame& frame, LengthUnit unit,
                      std::ostream& stream) {
  const DxfOutput out{stream, unit};
  const std::vector<std::string> section_layers = SectionLayers(report);
  std::vector<std::string> layers = section_layers;
  layers.push_back("MARKERS");
  std::vector<std::vector<Eigen::Vector3d>> curves_mm;
  Eigen::AlignedBox3d extent_mm;
  for (const Section& section : report.sections) {
    curves_mm.emplace_back();
    for (const ProfilePoint& point : SampleProfile(section, kNumProfilePoints)) {
      curves_mm.back().push_back(kMmPerM * point.x_in_frame_m);
      extent_mm.extend(curves_mm.back().back());
    }
    for (const SectionMarker& marker : section.markers) {
      extent_mm.extend((kMmPerM * marker.x_in_frame_m).eval());
    }
  }
  WriteHeader(frame, layers, extent_mm, out);
  for (std::size_t i = 0; i < curves_mm.size(); ++i) {
    WritePolyline(curves_mm[i], section_layers[i], out);
    for (const SectionMarker& marker : report.sections[i].markers) {
      WriteMarkerPoint(kMmPerM * marker.x_in_frame_m, out);
    }
  }
  WriteEnd(out);
}

void WriteSectionProfilesDxf(const SectionReport& report, const ShapeFrame& frame, LengthUnit unit,
                             std::ostream& stream) {
  const DxfOutput out{stream, unit};
  const std::vector<std::string> section_layers = SectionLayers(report);
  std::vector<std::string> layers = section_layers;
  for (const char* layer : {"MARKERS", "CHORDS", "NAMES"}) layers.push_back(layer);
  double largest_mm = 0.0;
  for (const Section& section : report.sections) {
    largest_mm =
        std::max(largest_mm, kMmPerM * std::abs(section.camber.value) * section.chord_m.value);
  }
  const double step_mm = largest_mm + std::max(kMinGap_mm, kGapPerDepth * largest_mm);
  Eigen::AlignedBox3d extent_mm;
  std::vector<std::vector<Eigen::Vector3d>> curves_mm;
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    curves_mm.emplace_back();
    for (const ProfilePoint& point : SampleProfile(report.sections[i], kNumProfilePoints)) {
      curves_mm.back().push_back(FlatPoint(point, step_mm * static_cast<double>(i)));
      extent_mm.extend(curves_mm.back().back());
    }
  }
  WriteHeader(frame, layers, extent_mm, out);
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    const double base_mm = step_mm * static_cast<double>(i);
    WritePolyline(curves_mm[i], section_layers[i], out);
    WritePolyline({curves_mm[i].front(), curves_mm[i].back()}, "CHORDS", out);
    WriteText({0, base_mm - 60, 0}, section.part + " " + section.name, out);
    for (const SectionMarker& marker : section.markers) {
      WriteMarkerPoint(FlatPoint(ProfilePointOf(section, marker.x_in_frame_m), base_mm), out);
    }
  }
  WriteEnd(out);
}

}  // namespace velamap
