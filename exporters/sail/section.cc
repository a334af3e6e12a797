#include "exporters/sail/section.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "exporters/sail/rig_numbers.h"
#include "exporters/sail/section_lines.h"
#include "exporters/sail/section_numbers.h"
#include "exporters/sail/section_twist.h"
#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kMinCamber = 1e-3;
constexpr const char* kBoomPart = "boom";
constexpr const char* kCenterlinePart = "centerline";

MarkerCenters CollectCenters(const MarkerShape& shape, const Layout& layout,
                             const PointCovariance* covariance) {
  std::set<int> ids;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    for (const auto* lines : {&part.horizontal, &part.vertical}) {
      for (const MarkerLine& line : *lines) {
        ids.insert(line.marker_ids.begin(), line.marker_ids.end());
      }
    }
  }
  for (const char* part : {kBoomPart, kCenterlinePart}) {
    for (const int id : MarkersOfPart(layout, part)) ids.insert(id);
  }
  MarkerCenters centers;
  for (const int id : ids) {
    if (FindWholeMarker(shape, id) != nullptr) centers.marker_ids.push_back(id);
  }
  const auto num_markers = static_cast<Eigen::Index>(centers.marker_ids.size());
  centers.x_m.resize(3, num_markers);
  std::vector<CornerId> points;
  for (const int id : centers.marker_ids) points.push_back({id, 0});
  centers.covariance_m2 = JointCovarianceOfPoints(covariance, points);
  for (Eigen::Index i = 0; i < num_markers; ++i) {
    const ShapeMarker& marker =
        *FindWholeMarker(shape, centers.marker_ids[static_cast<std::size_t>(i)]);
    centers.x_m.col(i) = *marker.x_in_shape_m[0];
    const bool in_covariance = PointSigma(covariance, marker.marker_id, 0).has_value();
    centers.has_sigma.push_back(covariance != nullptr ? in_covariance
                                                      : marker.sigma_m[0].has_value());
    if (covariance != nullptr || !marker.sigma_m[0]) continue;
    centers.covariance_m2.diagonal().segment<3>(3 * i) = marker.sigma_m[0]->cwiseAbs2();
  }
  return centers;
}

// The two markers of the part that are farthest apart, the forward one first.
std::optional<MarkerPair> FindPair(const char* part, const Layout& layout,
                                   const MarkerCenters& centers, const Eigen::Vector3d& aft) {
  std::vector<int> indices;
  for (const int id : MarkersOfPart(layout, part)) {
    if (const auto index = centers.IndexOf(id)) indices.push_back(*index);
  }
  std::optional<MarkerPair> pair;
  double longest = 0.0;
  for (const int a : indices) {
    for (const int b : indices) {
      const Eigen::Vector3d along = centers.x_m.col(b) - centers.x_m.col(a);
      if (along.dot(aft) <= 0 || along.norm() <= longest) continue;
      longest = along.norm();
      pair = MarkerPair{a, b};
    }
  }
  return pair;
}

Section DescribeSection(const PartContext& context, const SpaceCurve& curve,
                        const NumbersWithGradient& own) {
  const auto estimate = [&](SectionNumber number) {
    return Estimate{own.numbers[number], SigmaOf(number, context.centers, own)};
  };
  Section section;
  section.part = context.part.name;
  section.curve = curve;
  const ProfileAxes axes = ProfileAxesOf(curve, context.axes);
  section.chord_direction = axes.chord;
  section.depth_direction = axes.depth;
  section.height_m = MiddleHeight(curve, context.axes.up);
  section.chord_m = estimate(kChord);
  section.camber = estimate(kCamber);
  if (std::abs(section.camber.value) >= kMinCamber)
    section.draft_position = estimate(kDraftPosition);
  section.entry_angle_deg = estimate(kEntryAngle);
  section.exit_angle_deg = estimate(kExitAngle);
  section.girth_m = estimate(kGirth);
  return section;
}

void AddMarkers(const PartContext& context, const LineCurve& line, Section* section) {
  section->num_effective_parameters = line.fit.num_effective_parameters;
  for (std::size_t i = 0; i < line.indices.size(); ++i) {
    SectionMarker marker;
    marker.marker_id = context.centers.marker_ids[static_cast<std::size_t>(line.indices[i])];
    marker.x_in_frame_m = context.centers.x_m.col(line.indices[i]);
    marker.residual_m = section->depth_direction.dot(
        marker.x_in_frame_m -
        EvaluateCurve(line.fit.curve, line.fit.parameters[static_cast<Eigen::Index>(i)]));
    section->markers.push_back(marker);
  }
  const std::vector<int>& of_line =
      context.part.horizontal[static_cast<std::size_t>(line.place_in_layout)].marker_ids;
  const auto first = std::find(of_line.begin(), of_line.end(), section->markers.front().marker_id);
  const auto last = std::find(of_line.rbegin(), of_line.rend(), section->markers.back().marker_id);
  section->num_missing_at_luff = static_cast<int>(first - of_line.begin());
  section->num_missing_at_leech = static_cast<int>(last - of_line.rbegin());
  section->reaches_luff = line.luff_offset_m.has_value();
  section->reaches_leech = line.leech_offset_m.has_value();
}

// The number of missing markers of a height is the larger one of the lines next to it, below and
// above, and it reaches the edges that both reach. The first `num_lines` sections are lines, from
// the lowest up; the others are heights.
void AddMissingEndsOfHeights(std::size_t num_lines, std::vector<Section>* sections) {
  for (std::size_t i = num_lines; i < sections->size(); ++i) {
    Section& height = (*sections)[i];
    height.reaches_luff = height.reaches_leech = true;
    std::size_t above = 0;
    while (above < num_lines && (*sections)[above].height_m <= height.height_m) ++above;
    for (std::size_t j = above > 0 ? above - 1 : 0; j < std::min(above + 1, num_lines); ++j) {
      const Section& line = (*sections)[j];
      height.num_missing_at_luff = std::max(height.num_missing_at_luff, line.num_missing_at_luff);
      height.num_missing_at_leech =
          std::max(height.num_missing_at_leech, line.num_missing_at_leech);
      height.reaches_luff = height.reaches_luff && line.reaches_luff;
      height.reaches_leech = height.reaches_leech && line.reaches_leech;
    }
  }
}

// The sections of a part: lines, from the lowest up, then heights.
struct PartSections {
  std::vector<Section> sections;
  std::vector<NumbersWithGradient> numbers;
};

PartSections CollectSections(const PartContext& context,
                             const std::vector<double>& wanted_heights_m, SectionReport* report) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  PartSections part;
  auto& [sections, numbers] = part;
  for (const LineCurve& line : lines) {
    numbers.push_back(NumbersOfLine(context, line));
    sections.push_back(DescribeSection(context, line.curve, numbers.back()));
    sections.back().name = line.name;
    AddMarkers(context, line, &sections.back());
  }
  const std::set<double> heights_m(wanted_heights_m.begin(), wanted_heights_m.end());
  for (const double height_m : heights_m) {
    const std::string name = fmt::format("height={}", height_m);
    const HeightCut cut = CutAtHeight(SampleLines(lines), context.axes.up, height_m);
    if (!cut.curve) {
      report->missing.push_back({context.part.name, name, cut.reason});
      continue;
    }
    numbers.push_back(NumbersOfCut(context, *cut.curve, height_m));
    sections.push_back(DescribeSection(context, *cut.curve, numbers.back()));
    sections.back().name = name;
    sections.back().is_line = false;
  }
  AddMissingEndsOfHeights(lines.size(), &sections);
  return part;
}

void AddPartSections(const PartContext& context, const std::optional<MarkerPair>& boom,
                     const std::optional<MarkerPair>& centerline, const std::string& up_reference,
                     const SectionOptions& options, SectionReport* report) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  for (const MissingLine& line : context.curves.missing) {
    report->missing.push_back({context.part.name, line.name, line.reason, line.is_by_layout});
  }
  const std::vector<std::string>& crossings = context.curves.crossings;
  report->notes.insert(report->notes.end(), crossings.begin(), crossings.end());
  if (lines.empty()) return;

  auto [sections, numbers] = CollectSections(context, options.heights_m, report);
  const ReferenceSection reference = ChooseReferenceSection(context, sections);
  std::optional<NumbersWithGradient> of_boom;
  if (boom) of_boom = NumbersOfPair(context, *boom);
  SetTwists(context, numbers, reference, of_boom ? &*of_boom : nullptr, &sections);
  const NumbersWithGradient* of_section =
      reference.line_idx ? &numbers[*reference.line_idx] : nullptr;
  report->rigs.push_back(
      ComputeRigNumbers(context, centerline, reference, of_boom ? &*of_boom : of_section));
  report->rigs.back().twist_reference = boom ? kBoomPart : reference.Text();
  report->rigs.back().up_reference = up_reference;
  const std::string note =
      ReferenceNote(reference, context.part.name, boom.has_value(), centerline.has_value());
  if (!note.empty()) report->notes.push_back(note);
  const std::string edges = EdgesBeyondMarkers(lines);
  if (!edges.empty()) {
    report->notes.push_back(
        fmt::format("sections of {} go on beyond the outer markers, to the edge of the cloth at {}",
                    context.part.name, edges));
  }
  std::stable_sort(sections.begin(), sections.end(),
                   [](const Section& a, const Section& b) { return a.height_m < b.height_m; });
  for (Section& section : sections) report->sections.push_back(std::move(section));
}

struct SectionUp {
  std::optional<Eigen::Vector3d> direction;  // unit
  std::string reference;                     // RigNumbers::up_reference
};

// Up of a part: along its luff if two of its markers are whole, otherwise SailUp(), otherwise of
// the frame. The frame only decides which end is the head.
SectionUp ChooseSectionUp(const MarkerShape& shape, const ShapeFrame& frame,
                          const LayoutPart& part) {
  const std::optional<Eigen::Vector3d> luff = LuffDirection(shape, part);
  const std::optional<Eigen::Vector3d> sail = SailUp(shape, part);
  const std::optional<Eigen::Vector3d> along = luff ? luff : sail;
  if (!along) return {frame.up_in_frame, "z of the frame"};
  // Some layouts list the lines from head to foot. The up direction of the frame, or otherwise of
  // the lines, decides which end is the head if it is within 60 degrees of the luff.
  const std::optional<Eigen::Vector3d>& hint = frame.up_in_frame ? frame.up_in_frame : sail;
  const bool is_down = hint && PointsDown(*along, *hint);
  return {is_down ? Eigen::Vector3d(-*along) : *along, luff ? "luff" : "lines"};
}

SectionAxes AxesOf(const std::vector<LineCurve>& lines, const Eigen::Vector3d& up) {
  // Azimuths relative to the lowest chord are far from the jump at 180 degrees.
  SectionAxes axes{up, ChordOf(lines.front().fit.curve), 1};
  double depth_m = 0.0;
  for (const LineCurve& line : lines) depth_m += MeanDepth(line.fit.curve, axes);
  if (depth_m < 0) axes.leeward = -1;
  return axes;
}

}  // namespace

std::string MissingEndsText(const Section& section) {
  return MissingEndsText(section.num_missing_at_luff, section.num_missing_at_leech);
}

SectionReport ComputeSections(const MarkerShape& shape, const ShapeFrame& frame,
                              const Layout& layout, const PointCovariance* covariance,
                              const SectionOptions& options) {
  options.Check();
  SectionReport report;
  if (FirstPartWithLines(layout) == nullptr) {
    report.notes.push_back("no sections: the layout has no horizontal lines");
    return report;
  }
  const MarkerCenters centers = CollectCenters(shape, layout, covariance);
  const bool wants_boom = !MarkersOfPart(layout, kBoomPart).empty();
  for (const LayoutPart& part : layout.parts) {
    const bool is_wanted = options.part.empty() || part.name == options.part;
    if (part.horizontal.empty() || !is_wanted) continue;
    const SectionUp up = ChooseSectionUp(shape, frame, part);
    if (!up.direction) {
      report.notes.push_back(fmt::format(
          "no sections of {}: the markers of its lines do not determine which way is up",
          part.name));
      continue;
    }
    PartContext context{part, centers, {*up.direction, {}, 1}, {}};
    context.curves = FitPartLines(part, centers, FindSideEdges(shape, part, *up.direction),
                                  *up.direction, options.min_markers);
    std::optional<MarkerPair> boom, centerline;
    if (!context.curves.lines.empty()) {
      context.axes = AxesOf(context.curves.lines, *up.direction);
      centerline = FindPair(kCenterlinePart, layout, centers, context.axes.reference);
      // A boat has one boom, which carries the first sail of the layout.
      const bool is_first = &part == FirstPartWithLines(layout);
      if (is_first) boom = FindPair(kBoomPart, layout, centers, context.axes.reference);
      if (is_first && wants_boom && !boom) {
        report.notes.push_back(
            "twist does not count from the boom: fewer than two of its markers are whole");
      }
    }
    AddPartSections(context, boom, centerline, up.reference, options, &report);
  }
  return report;
}

ProfilePoint ProfilePointOf(const Section& section, const Eigen::Vector3d& x_in_frame_m) {
  const Eigen::Vector3d rest = x_in_frame_m - EvaluateCurve(section.curve, 0.0);
  return {x_in_frame_m, section.chord_direction.dot(rest), section.depth_direction.dot(rest)};
}

std::vector<ProfilePoint> SampleProfile(const Section& section, int num_points) {
  VELAMAP_CHECK(num_points >= 2);
  std::vector<ProfilePoint> points;
  for (int i = 0; i < num_points; ++i) {
    const double t = static_cast<double>(i) / (num_points - 1);
    points.push_back(ProfilePointOf(section, EvaluateCurve(section.curve, t)));
  }
  return points;
}

}  // namespace velamap
