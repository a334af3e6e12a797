#include "tests/reconstruct/evidence/random_sail.h"

#include <algorithm>
#include <cmath>

namespace velamap {
namespace {

using Generator = std::mt19937;

double Uniform(double low, double high, Generator* generator) {
  return std::uniform_real_distribution<double>(low, high)(*generator);
}

bool Chance(double probability, Generator* generator) {
  return Uniform(0, 1, generator) < probability;
}

int UniformInt(int low, int high, Generator* generator) {
  return std::uniform_int_distribution<int>(low, high)(*generator);
}

Eigen::Vector3d RandomDirection(Generator* generator) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(*generator), normal(*generator), normal(*generator)).normalized();
}

// A line of markers along an arc that turns by `turn_rad`, at distances that differ.
std::vector<Eigen::Vector3d> DrawLine(int num_markers, double height_m, double turn_rad,
                                      double twist_rad, double step_m, double unevenness,
                                      Generator* generator) {
  std::vector<double> along_m = {0.0};
  for (int i = 1; i < num_markers; ++i) {
    along_m.push_back(along_m.back() + step_m * Uniform(1 - unevenness, 1 + unevenness, generator));
  }
  if (Chance(0.15, generator)) {  // one place is much wider than the others, often at an end
    const int wide =
        Chance(0.5, generator) ? num_markers - 1 : UniformInt(1, num_markers - 1, generator);
    for (int i = wide; i < num_markers; ++i) along_m[static_cast<std::size_t>(i)] += 1.5 * step_m;
  }
  const double radius_m = along_m.back() / turn_rad;
  std::vector<Eigen::Vector3d> line;
  for (const double s_m : along_m) {
    const double angle = s_m / radius_m - turn_rad / 2;
    const Eigen::Vector2d flat(radius_m * (std::sin(angle) + std::sin(turn_rad / 2)),
                               radius_m * (std::cos(angle) - std::cos(turn_rad / 2)));
    const Eigen::Rotation2Dd twist(twist_rad);
    const Eigen::Vector2d turned = twist * flat;
    line.emplace_back(turned.x(), turned.y(), height_m);
  }
  return line;
}

// Moves all markers behind a place of the line, where at least two are left on both sides.
void TearLine(const std::vector<int>& ids, double distance_m, RandomSail* sail,
              Generator* generator) {
  std::vector<PlacedMarker*> on_line;
  for (const int id : ids) {
    if (PlacedMarker* marker = sail->Find(id)) on_line.push_back(marker);
  }
  if (on_line.size() < 4) return;
  const auto tear =
      static_cast<std::size_t>(UniformInt(2, static_cast<int>(on_line.size()) - 2, generator));
  const Eigen::Vector3d shift_m = distance_m * RandomDirection(generator);
  for (std::size_t i = tear; i < on_line.size(); ++i) on_line[i]->center_in_shape_m += shift_m;
}

void SetSeen(Seen seen, PlacedMarker* marker, Generator* generator) {
  marker->num_should_see = UniformInt(30, 80, generator);
  marker->num_seen_of_these =
      seen == Seen::kSeldom
          ? UniformInt(2, 3, generator)
          : static_cast<int>(Uniform(0.7, 1.0, generator) * marker->num_should_see);
  marker->num_seen = marker->num_seen_of_these;
}

PlacedMarker DrawMarker(int id, const Eigen::Vector3d& x_m, double noise_m, Generator* generator) {
  std::normal_distribution<double> normal(0.0, noise_m);
  PlacedMarker marker;
  marker.marker_id = id;
  marker.center_in_shape_m =
      x_m + Eigen::Vector3d(normal(*generator), normal(*generator), normal(*generator));
  marker.sigma_m = noise_m;
  SetSeen(Chance(0.05, generator) ? Seen::kSeldom : Seen::kOften, &marker, generator);
  return marker;
}

}  // namespace

PlacedMarker* RandomSail::Find(int marker_id) {
  const auto it = std::find_if(markers.begin(), markers.end(), [marker_id](const auto& marker) {
    return marker.marker_id == marker_id;
  });
  return it == markers.end() ? nullptr : &*it;
}

int RandomSail::NumOnLine(const MarkerLine& line) {
  return static_cast<int>(std::count_if(line.marker_ids.begin(), line.marker_ids.end(),
                                        [this](int id) { return Find(id) != nullptr; }));
}

RandomSail DrawSail(Cloth cloth, Generator* generator) {
  RandomSail sail;
  sail.step_m = std::pow(10.0, Uniform(-2, 1, generator));  // any scale
  LayoutPart part;
  part.name = "sail";
  const int num_lines = UniformInt(2, 7, generator);
  const double missing_rate = Uniform(0, 0.5, generator), noise = Uniform(0, 0.05, generator);
  const double unevenness = Chance(0.5, generator) ? Uniform(0, 0.5, generator) : 0.0;
  const double turn_rad = Chance(0.2, generator) ? Uniform(2, 5, generator)  // rolled up
                                                 : Uniform(0.01, 1.5, generator);
  const double twist_rad = Uniform(-1, 1, generator);
  const int most = UniformInt(3, 20, generator), fewest = UniformInt(2, most, generator);
  int next_id = 0;
  std::vector<MarkerLine> vertical(1);
  vertical[0].name = "v1";
  for (int i = 0; i < num_lines; ++i) {
    const int num_markers = std::max(2, most - i * (most - fewest) / num_lines);
    const auto line_m = DrawLine(num_markers, 3 * i * sail.step_m, turn_rad,
                                 twist_rad * i / num_lines, sail.step_m, unevenness, generator);
    MarkerLine line{"h" + std::to_string(i + 1), {}};
    const bool first_is_missing = Chance(0.2, generator), last_is_missing = Chance(0.2, generator);
    for (int k = 0; k < num_markers; ++k) {
      line.marker_ids.push_back(next_id);
      if (k == num_markers / 2) vertical[0].marker_ids.push_back(next_id);
      const bool is_missing = (k == 0 && first_is_missing) ||
                              (k == num_markers - 1 && last_is_missing) ||
                              Chance(missing_rate, generator);
      if (!is_missing) {
        sail.markers.push_back(DrawMarker(next_id, line_m[static_cast<std::size_t>(k)],
                                          noise * sail.step_m, generator));
      }
      ++next_id;
    }
    part.horizontal.push_back(std::move(line));
  }
  if (Chance(0.5, generator)) part.vertical = vertical;
  sail.layout.parts.push_back(std::move(part));
  if (cloth == Cloth::kTornAtTimes && Chance(0.2, generator)) {
    TearLine(sail.layout.parts[0].horizontal.front().marker_ids,
             Uniform(1, 30, generator) * sail.step_m, &sail, generator);
  }
  return sail;
}

int MoveOne(int min_on_line, double num_steps, Seen seen, RandomSail* sail, Generator* generator) {
  std::vector<int> candidates;
  for (const MarkerLine& line : sail->layout.parts[0].horizontal) {
    if (sail->NumOnLine(line) < min_on_line) continue;
    for (const int id : line.marker_ids) {
      if (sail->Find(id) != nullptr) candidates.push_back(id);
    }
  }
  if (candidates.empty()) return -1;
  const int id = candidates[static_cast<std::size_t>(
      UniformInt(0, static_cast<int>(candidates.size()) - 1, generator))];
  PlacedMarker* marker = sail->Find(id);
  marker->center_in_shape_m += num_steps * sail->step_m * RandomDirection(generator);
  SetSeen(seen, marker, generator);
  return id;
}

}  // namespace velamap
