#include "importer/rotation/rotation_evidence.h"
#include "importer/base/statistics.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/LU>

namespace velamap {
namespace {

constexpr std::size_t kMinFrames = 3;
constexpr double kMinAgreement = 0.9;
// A quarter of the angle between the possible turns of a marker: 45 and 22.5 degrees.
constexpr double kMinCosineHalfTurn = 0.70710678118654752;
constexpr double kMinCosineQuarterTurn = 0.92387953251128674;
// Tolerance of a place, which bent cloth and perspective change: in sides of the other marker, and
// as a fraction of the distance.
constexpr double kMaxPlaceError = 0.5;
constexpr double kMaxRelativePlaceError = 0.3;

// A marker in the affine frame that the sides of another one span.
struct Relation {
  Eigen::Vector2d top_side;  // unit vector
  Eigen::Vector2d place;     // of the centre, in sides
};

// The mean of the top and the bottom side.
Eigen::Vector2d MeanTopSide(const MarkerDetection& marker) {
  const auto& x = marker.corners_in_image_px;
  return 0.5 * (x[1] - x[0] + x[2] - x[3]);
}

Relation RelationTo(const MarkerDetection& other, const MarkerDetection& marker) {
  const auto& x = other.corners_in_image_px;
  Eigen::Matrix2d sides;
  sides << MeanTopSide(other), 0.5 * (x[3] - x[0] + x[2] - x[1]);
  const Eigen::Matrix2d other_from_image = sides.inverse();
  return {(other_from_image * MeanTopSide(marker)).normalized(),
          other_from_image * (CornerMean(marker) - CornerMean(other))};
}

double MinCosine(const std::vector<int>& turns) {
  return turns.size() > 1 ? kMinCosineQuarterTurn : kMinCosineHalfTurn;
}

bool HasSamePlace(const Relation& a, const Relation& known) {
  return (a.place - known.place).norm() <=
         kMaxPlaceError + kMaxRelativePlaceError * known.place.norm();
}

bool HasSameDirection(const Relation& a, const Relation& known, double min_cosine) {
  return a.top_side.dot(known.top_side) >= min_cosine;
}

// The relation on which the frames agree; nothing if too few show it or too many depart from it.
std::optional<Relation> Consensus(const std::vector<Relation>& relations, double min_cosine) {
  if (relations.size() < kMinFrames) return std::nullopt;
  Relation known{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  std::vector<double> x, y;
  for (const Relation& relation : relations) {
    known.top_side += relation.top_side;
    x.push_back(relation.place.x());
    y.push_back(relation.place.y());
  }
  known.top_side.normalize();
  known.place = {Median(std::move(x)), Median(std::move(y))};
  const auto num_agreeing =
      std::count_if(relations.begin(), relations.end(), [&](const Relation& relation) {
        return HasSamePlace(relation, known) && HasSameDirection(relation, known, min_cosine);
      });
  if (static_cast<double>(num_agreeing) < kMinAgreement * static_cast<double>(relations.size())) {
    return std::nullopt;
  }
  return known;
}

bool IsDoubtful(const RejectedDetection& rejected) { return rejected.reason == kDoubtfulRotation; }

// Keys are the ids of a symmetric marker and of another one.
using KnownRelations = std::map<std::pair<int, int>, Relation>;

// Relations of all markers that are unresolved in some frame.
KnownRelations LearnRelations(const CodeSymmetries& symmetries,
                              const std::vector<FrameDetections>& frames) {
  std::set<int> doubtful_ids;
  for (const FrameDetections& frame : frames) {
    for (const RejectedDetection& rejected : frame.rejected) {
      if (IsDoubtful(rejected)) doubtful_ids.insert(rejected.detection.marker_id);
    }
  }
  std::map<std::pair<int, int>, std::vector<Relation>> seen;
  for (const FrameDetections& frame : frames) {
    for (const MarkerDetection& marker : frame.markers) {
      if (doubtful_ids.count(marker.marker_id) == 0) continue;
      for (const MarkerDetection& other : frame.markers) {
        if (other.marker_id == marker.marker_id) continue;
        seen[{marker.marker_id, other.marker_id}].push_back(RelationTo(other, marker));
      }
    }
  }
  KnownRelations known;
  for (const auto& [ids, relations] : seen) {
    const auto consensus = Consensus(relations, MinCosine(symmetries.at(ids.first)));
    if (consensus) known.emplace(ids, *consensus);
  }
  return known;
}

// The turn on which all known relations with the markers of the frame agree; -1 if there are none
// or they disagree. A marker that is not where it should be, such as a false id, is ignored.
int ChooseTurnByRelations(const MarkerDetection& marker, const std::vector<int>& possible_turns,
                          const KnownRelations& known, const std::vector<MarkerDetection>& others) {
  std::vector<int> turns = {0};
  turns.insert(turns.end(), possible_turns.begin(), possible_turns.end());
  int chosen = -1;
  for (const MarkerDetection& other : others) {
    const auto relation = known.find({marker.marker_id, other.marker_id});
    if (relation == known.end() || !HasSamePlace(RelationTo(other, marker), relation->second)) {
      continue;
    }
    const auto wanted = std::find_if(turns.begin(), turns.end(), [&](int turn) {
      return HasSameDirection(RelationTo(other, Turned(marker, turn)), relation->second,
                              MinCosine(possible_turns));
    });
    if (wanted == turns.end() || (chosen >= 0 && chosen != *wanted)) return -1;
    chosen = *wanted;
  }
  return chosen;
}

void SortById(std::vector<MarkerDetection>* markers) {
  std::stable_sort(markers->begin(), markers->end(),
                   [](const auto& a, const auto& b) { return a.marker_id < b.marker_id; });
}

// Resolves a frame alone, from its resolved and its unresolved markers.
void ResolveAlone(const CodeSymmetries& symmetries, const AdjacencyGraph& graph,
                  FrameDetections* frame) {
  std::vector<RejectedDetection> others;
  for (RejectedDetection& rejected : frame->rejected) {
    if (IsDoubtful(rejected)) {
      frame->markers.push_back(rejected.detection);
    } else {
      others.push_back(std::move(rejected));
    }
  }
  frame->rejected = std::move(others);
  SortById(&frame->markers);
  ResolveRotations(symmetries, graph, &frame->markers, &frame->rejected);
}

// Returns whether any marker of the frame was resolved.
bool ResolveByOthers(const CodeSymmetries& symmetries, const KnownRelations& known,
                     FrameDetections* frame) {
  std::vector<MarkerDetection> resolved;
  std::vector<RejectedDetection> rest;
  for (const RejectedDetection& rejected : frame->rejected) {
    const MarkerDetection& marker = rejected.detection;
    const int turn =
        IsDoubtful(rejected)
            ? ChooseTurnByRelations(marker, symmetries.at(marker.marker_id), known, frame->markers)
            : -1;
    if (turn >= 0) {
      resolved.push_back(Turned(marker, turn));
    } else {
      rest.push_back(rejected);
    }
  }
  frame->rejected = std::move(rest);
  std::copy(resolved.begin(), resolved.end(), std::back_inserter(frame->markers));
  SortById(&frame->markers);
  return !resolved.empty();
}

bool HaveSameCorners(const std::vector<MarkerDetection>& a, const std::vector<MarkerDetection>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.marker_id == y.marker_id && x.corners_in_image_px == y.corners_in_image_px;
  });
}

}  // namespace

std::vector<std::size_t> ResolveRotationsAcrossFrames(const CodeSymmetries& symmetries,
                                                      const AdjacencyGraph& graph,
                                                      std::vector<FrameDetections>* frames) {
  if (symmetries.empty()) return {};
  const std::vector<FrameDetections> before = *frames;
  for (FrameDetections& frame : *frames) ResolveAlone(symmetries, graph, &frame);
  // Every round but the last resolves a marker, so the loop ends.
  for (bool any = true; any;) {
    any = false;
    const KnownRelations known = LearnRelations(symmetries, *frames);
    for (FrameDetections& frame : *frames) any |= ResolveByOthers(symmetries, known, &frame);
  }
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    if (!HaveSameCorners(before[i].markers, (*frames)[i].markers)) changed.push_back(i);
  }
  return changed;
}

}  // namespace velamap
