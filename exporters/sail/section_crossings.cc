#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/sail/section_lines.h"
#include "importer/geometry/quad.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Two lines that cross, the lower one first, as indices from the lowest line up.
struct Crossing {
  std::size_t lower, upper;
  std::string text;
};

// How two lines that are compared at equal fractions of their lengths cross; empty if they do not.
std::string CrossingAlongText(const LineCurve& lower, const LineCurve& upper,
                              const Eigen::Vector3d& up) {
  Eigen::Index place = 0;
  const double gap_m =
      (up.transpose() * (SampleForCut(upper.fit.curve) - SampleForCut(lower.fit.curve)))
          .minCoeff(&place);
  if (gap_m > 0) return "";
  return fmt::format(
      "sections {} and {} cross: at {:.0f} % of their length {} is {:.1f} mm below {}", lower.name,
      upper.name, 100 * CutFractions()[place], upper.name, -kMmPerM * gap_m, lower.name);
}

// The same as seen from the side, along `aside`, where lines of different lengths are compared at
// other places than by fractions.
std::string SideViewCrossingText(const LineCurve& lower, const LineCurve& upper,
                                 const Eigen::Vector3d& up, const Eigen::Vector3d& aside) {
  Eigen::Matrix<double, 2, 3> side_from_frame;
  side_from_frame << up.cross(aside).transpose(), up.transpose();
  const Eigen::Matrix2Xd a = side_from_frame * SampleForCut(lower.fit.curve);
  const Eigen::Matrix2Xd b = side_from_frame * SampleForCut(upper.fit.curve);
  const auto side_of = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                          const Eigen::Vector2d& point) { return Cross(to - from, point - from); };
  for (Eigen::Index i = 1; i < a.cols(); ++i) {
    for (Eigen::Index j = 1; j < b.cols(); ++j) {
      if (side_of(a.col(i - 1), a.col(i), b.col(j - 1)) *
                  side_of(a.col(i - 1), a.col(i), b.col(j)) <
              0 &&
          side_of(b.col(j - 1), b.col(j), a.col(i - 1)) *
                  side_of(b.col(j - 1), b.col(j), a.col(i)) <
              0) {
        return fmt::format("sections {} and {} cross, seen from the side, at {:.0f} % of {}",
                           lower.name, upper.name, 100 * CutFractions()[i], lower.name);
      }
    }
  }
  return "";
}

// Whether most pairs of lines stand in the order of the layout: some list the head first.
bool IsListedFromTheFoot(const std::vector<LineCurve>& lines) {
  int balance = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      balance += lines[j].place_in_layout > lines[i].place_in_layout ? 1 : -1;
    }
  }
  return balance >= 0;
}

std::vector<Crossing> FindCrossings(const std::vector<LineCurve>& lines,
                                    const Eigen::Vector3d& up) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const LineCurve& line : lines) along += ChordOf(line.fit.curve);
  const Eigen::Vector3d aside = along.cross(up).normalized();
  const bool from_the_foot = IsListedFromTheFoot(lines);
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      std::string text = CrossingAlongText(lines[i], lines[j], up);
      if (text.empty()) text = SideViewCrossingText(lines[i], lines[j], up, aside);
      const bool is_above = lines[j].place_in_layout > lines[i].place_in_layout;
      if (text.empty() && is_above != from_the_foot) {
        text = fmt::format(
            "sections {} and {} are in the wrong order: {} is {:.1f} mm above {}, and the layout "
            "lists it below",
            lines[i].name, lines[j].name, lines[j].name,
            kMmPerM * (MiddleHeight(lines[j].fit.curve, up) - MiddleHeight(lines[i].fit.curve, up)),
            lines[i].name);
      }
      if (!text.empty()) crossings.push_back({i, j, std::move(text)});
    }
  }
  return crossings;
}

// The lines to leave out so that none of the others cross.
std::set<std::size_t> LinesToLeaveOut(const std::vector<Crossing>& crossings) {
  std::set<std::size_t> left_out;
  while (true) {
    std::map<std::size_t, int> num_crossings;
    for (const Crossing& crossing : crossings) {
      if (left_out.count(crossing.lower) + left_out.count(crossing.upper) > 0) continue;
      ++num_crossings[crossing.lower];
      ++num_crossings[crossing.upper];
    }
    if (num_crossings.empty()) return left_out;
    int most = 0;
    for (const auto& [line, num] : num_crossings) most = std::max(most, num);
    for (const auto& [line, num] : num_crossings) {
      if (num == most) left_out.insert(line);
    }
  }
}

}  // namespace

void LeaveOutCrossing(const Eigen::Vector3d& up, PartCurves* curves) {
  const std::vector<Crossing> crossings = FindCrossings(curves->lines, up);
  const std::set<std::size_t> left_out = LinesToLeaveOut(crossings);
  std::map<std::size_t, std::string> reasons;
  for (const Crossing& crossing : crossings) {
    std::string names;
    for (const std::size_t line : {crossing.lower, crossing.upper}) {
      if (left_out.count(line) == 0) continue;
      reasons.emplace(line, crossing.text);
      names += (names.empty() ? "" : " and ") + curves->lines[line].name;
    }
    curves->crossings.push_back(fmt::format("{}; {} left out", crossing.text, names));
  }
  std::vector<LineCurve> kept;
  for (std::size_t i = 0; i < curves->lines.size(); ++i) {
    if (left_out.count(i) > 0) {
      curves->missing.push_back({curves->lines[i].name, reasons.at(i)});
    } else {
      kept.push_back(std::move(curves->lines[i]));
    }
  }
  curves->lines = std::move(kept);
}

}  // namespace velamap
