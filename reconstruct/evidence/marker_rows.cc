#include "reconstruct/evidence/marker_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "importer/geometry/disjoint_sets.h"
#include "reconstruct/evidence/marker_clusters.h"
#include "reconstruct/evidence/marker_links.h"

namespace velamap {
namespace {

constexpr std::size_t kMinOnRow = 3;
constexpr double kParallel = 0.8;  // cosine
// Parallel rows belong together if their steps differ by at most the first factor and if they are
// at most the second number of steps apart.
constexpr double kLikeSteps = 1.6, kMaxStepsBetweenRows = 12.0;
// A marker on no row belongs to a group that has a marker within this many steps.
constexpr double kMaxStepsFromGroup = 2.0;

struct Row {
  MarkerChain chain;
  Eigen::Vector3d direction;  // from its first marker to its last one
  double step = 0.0;
  bool is_vertical = false;
};

Eigen::Vector3d MeanCenter(const std::vector<OrientedMarker>& markers, const MarkerChain& chain) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : chain) sum += markers[i].center_m;
  return sum / static_cast<double>(chain.size());
}

class RowFinder {
 public:
  explicit RowFinder(const ShapePoints& shape) : markers_(OrientedMarkers(shape)) {}

  std::vector<RowGroup> Find() {
    std::vector<Row> short_rows;
    for (const MarkerChain& chain : FindChains(markers_)) {
      Row row{chain, markers_[chain.back()].center_m - markers_[chain.front()].center_m,
              SpacingOf(markers_, chain)};
      row.direction.normalize();
      (chain.size() >= kMinOnRow ? rows_ : short_rows).push_back(std::move(row));
    }
    knows_up_ = KnowsUp();
    Classify(&short_rows);
    Classify(&rows_);
    KeepShortRows(std::move(short_rows));
    JoinRows();
    return Groups();
  }

 private:
  // Whether the markers tell which way is up: most neighbours on a row agree on the direction to
  // the right.
  bool KnowsUp() const {
    constexpr double kAgree = 0.7, kShare = 0.9;
    int num = 0, num_agreeing = 0;
    for (const Row& row : rows_) {
      for (std::size_t i = 1; i < row.chain.size(); ++i) {
        ++num;
        num_agreeing += markers_[row.chain[i - 1]].right.dot(markers_[row.chain[i]].right) > kAgree;
      }
    }
    return num_agreeing >= kShare * num;
  }

  void Classify(std::vector<Row>* rows) const {
    if (rows_.empty()) return;
    const Row& longest = *std::max_element(
        rows_.begin(), rows_.end(),
        [](const auto& a, const auto& b) { return a.chain.size() < b.chain.size(); });
    const Eigen::Vector3d reference = longest.direction;
    for (Row& row : *rows) {
      double along_right = 0.0, along_up = 0.0;
      for (const std::size_t i : row.chain) {
        along_right += std::abs(row.direction.dot(markers_[i].right));
        along_up += std::abs(row.direction.dot(markers_[i].up));
      }
      row.is_vertical =
          knows_up_ ? along_up > along_right : std::abs(row.direction.dot(reference)) < kParallel;
    }
  }

  // Keeps a horizontal row of two markers if neither is on a longer horizontal row and if a longer
  // row nearby is parallel to it and has about the same step. Near the head of a sail, lines are
  // short.
  void KeepShortRows(std::vector<Row> short_rows) {
    std::set<std::size_t> on_horizontal;
    for (const Row& row : rows_) {
      if (!row.is_vertical) on_horizontal.insert(row.chain.begin(), row.chain.end());
    }
    const std::size_t num_long = rows_.size();
    for (Row& row : short_rows) {
      if (row.is_vertical ||
          on_horizontal.count(row.chain[0]) + on_horizontal.count(row.chain[1]) > 0) {
        continue;
      }
      const bool is_like_one =
          std::any_of(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(num_long),
                      [&](const Row& other) { return AreTogether(row, other); });
      if (is_like_one) rows_.push_back(std::move(row));
    }
  }

  bool AreTogether(const Row& a, const Row& b) const {
    if (a.is_vertical || b.is_vertical || std::abs(a.direction.dot(b.direction)) < kParallel ||
        std::max(a.step, b.step) > kLikeSteps * std::min(a.step, b.step)) {
      return false;
    }
    constexpr double kFaceOfRow = 0.3;
    if (markers_[a.chain[0]].normal.dot(markers_[b.chain[0]].normal) < kFaceOfRow) return false;
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : a.chain) {
      for (const std::size_t j : b.chain) {
        nearest = std::min(nearest, Distance(markers_[i], markers_[j]));
      }
    }
    return nearest <= kMaxStepsBetweenRows * std::max(a.step, b.step);
  }

  void JoinRows() {
    DisjointSets by_markers(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t j = i + 1; j < rows_.size(); ++j) {
        if (ShareMarkers(rows_[i].chain, rows_[j].chain)) by_markers.Join(i, j);
      }
    }
    DisjointSets all = by_markers;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t j = i + 1; j < rows_.size(); ++j) {
        if (AreTogether(rows_[i], rows_[j])) all.Join(i, j);
      }
    }
    group_of_row_.clear();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      group_of_row_.push_back(all.Find(i));
      if (by_markers.Find(i) != by_markers.Find(all.Find(i)))
        joined_by_likeness_.insert(all.Find(i));
    }
  }

  std::vector<RowGroup> Groups() {
    std::set<std::size_t> on_rows;
    for (const Row& row : rows_) on_rows.insert(row.chain.begin(), row.chain.end());
    MarkerChain rest;
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      if (on_rows.count(i) == 0) rest.push_back(i);
    }
    std::vector<RowGroup> groups;
    for (const std::size_t group :
         std::set<std::size_t>(group_of_row_.begin(), group_of_row_.end())) {
      groups.push_back(MakeGroup(group, &rest));
    }
    for (const MarkerChain& cluster : FindClusters(markers_, rest)) {
      groups.emplace_back();
      groups.back().knows_up = knows_up_;
      for (const std::size_t i : cluster) groups.back().others.push_back(markers_[i].marker_id);
    }
    std::stable_sort(groups.begin(), groups.end(), [](const RowGroup& a, const RowGroup& b) {
      return a.MarkerIds().size() > b.MarkerIds().size();
    });
    return groups;
  }

  // Moves the markers near the rows from `rest` into the group.
  RowGroup MakeGroup(std::size_t group, MarkerChain* rest) {
    RowGroup result;
    result.knows_up = knows_up_;
    result.is_joined_by_likeness = joined_by_likeness_.count(group) > 0;
    std::vector<Row*> rows;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (group_of_row_[i] == group) rows.push_back(&rows_[i]);
    }
    const auto [right, up] = Axes(rows);
    std::vector<Row*> horizontal, vertical;
    for (Row* row : rows) {
      if (row->direction.dot(row->is_vertical ? up : right) < 0) {
        std::reverse(row->chain.begin(), row->chain.end());
        row->direction = -row->direction;
      }
      (row->is_vertical ? vertical : horizontal).push_back(row);
    }
    result.horizontal = InOrder(horizontal, up);
    result.vertical = InOrder(vertical, right);
    SetSlants(horizontal, up, &result);
    TakeNear(rows, rest, &result);
    return result;
  }

  // The mean directions of right and up over the rows.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> Axes(const std::vector<Row*>& rows) const {
    Eigen::Vector3d right = Eigen::Vector3d::Zero(), up = right, normal = right;
    const Row* longest = rows.front();
    for (const Row* row : rows) {
      if (!row->is_vertical && row->chain.size() > longest->chain.size()) longest = row;
      for (const std::size_t i : row->chain) {
        right += markers_[i].right;
        up += markers_[i].up;
        normal += markers_[i].normal;
      }
    }
    if (knows_up_) return {right.normalized(), up.normalized()};
    return {longest->direction, normal.cross(longest->direction).normalized()};
  }

  std::vector<std::vector<int>> InOrder(std::vector<Row*> rows, const Eigen::Vector3d& axis) const {
    std::stable_sort(rows.begin(), rows.end(), [&](const Row* a, const Row* b) {
      return MeanCenter(markers_, a->chain).dot(axis) < MeanCenter(markers_, b->chain).dot(axis);
    });
    std::vector<std::vector<int>> ids;
    for (const Row* row : rows) {
      ids.emplace_back();
      for (const std::size_t i : row->chain) ids.back().push_back(markers_[i].marker_id);
    }
    return ids;
  }

  void SetSlants(std::vector<Row*> rows, const Eigen::Vector3d& up, RowGroup* group) const {
    if (rows.size() < 2) return;
    const auto height = [&](const Row* row) { return MeanCenter(markers_, row->chain).dot(up); };
    const auto [lowest, highest] =
        std::minmax_element(rows.begin(), rows.end(),
                            [&](const Row* a, const Row* b) { return height(a) < height(b); });
    const Eigen::Vector3d along = ((*lowest)->direction + (*highest)->direction).normalized();
    const auto slant = [&](std::size_t low, std::size_t high) {
      return std::abs((markers_[high].center_m - markers_[low].center_m).normalized().dot(along));
    };
    group->left_slant = slant((*lowest)->chain.front(), (*highest)->chain.front());
    group->right_slant = slant((*lowest)->chain.back(), (*highest)->chain.back());
  }

  void TakeNear(const std::vector<Row*>& rows, MarkerChain* rest, RowGroup* group) const {
    const auto is_near = [&](std::size_t marker) {
      return std::any_of(rows.begin(), rows.end(), [&](const Row* row) {
        return std::any_of(row->chain.begin(), row->chain.end(), [&](std::size_t i) {
          return Distance(markers_[marker], markers_[i]) <= kMaxStepsFromGroup * row->step;
        });
      });
    };
    const auto far = std::stable_partition(rest->begin(), rest->end(), is_near);
    for (auto marker = rest->begin(); marker != far; ++marker) {
      group->others.push_back(markers_[*marker].marker_id);
    }
    rest->erase(rest->begin(), far);
    std::sort(group->others.begin(), group->others.end());
  }

  std::vector<OrientedMarker> markers_;  // by ascending id
  std::vector<Row> rows_;
  std::vector<std::size_t> group_of_row_;
  std::set<std::size_t> joined_by_likeness_;  // groups
  bool knows_up_ = true;
};

}  // namespace

std::vector<int> RowGroup::MarkerIds() const {
  std::set<int> ids(others.begin(), others.end());
  for (const auto* rows : {&horizontal, &vertical}) {
    for (const std::vector<int>& row : *rows) ids.insert(row.begin(), row.end());
  }
  return {ids.begin(), ids.end()};
}

std::vector<RowGroup> FindMarkerRows(const ShapePoints& shape) { return RowFinder(shape).Find(); }

}  // namespace velamap
