#include "workflows/check/clip_light.h"

#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/base/statistics.h"
#include "workflows/check/clip_limits.h"
#include "workflows/check/marker_light.h"

namespace velamap {
namespace {

// All that is measured; black and white as printed, also in an inverted picture.
struct Lights {
  std::vector<double> blacks, whites, blurs_px, motions_px;
  std::map<int, int> num_measured_of_id, num_poor_of_id;

  void Add(int marker_id, const MarkerLight& light, bool inverted) {
    blacks.push_back(inverted ? 255 - light.white : light.black);
    whites.push_back(inverted ? 255 - light.black : light.white);
    ++num_measured_of_id[marker_id];
    num_poor_of_id[marker_id] +=
        whites.back() > kMaxWhite || whites.back() - blacks.back() < kGoodContrast;
    blurs_px.push_back(light.least_blur_px);
    // A path of length l during the exposure adds l^2 / 12 to the variance across its edges.
    motions_px.push_back(
        std::sqrt(12.0 * (std::pow(light.most_blur_px, 2) - std::pow(light.least_blur_px, 2))));
  }
};

// A marker is in poor light if most of its pictures are.
void CollectPoorLight(const Lights& lights, ClipFacts* facts) {
  int num_poor = 0;
  for (const auto& [marker_id, num] : lights.num_poor_of_id) {
    num_poor += num;
    if (2 * num > lights.num_measured_of_id.at(marker_id)) {
      facts->ids_in_poor_light.push_back(marker_id);
    }
  }
  facts->poor_light_share = num_poor / static_cast<double>(lights.whites.size());
}

}  // namespace

void MeasureLights(const ClipFrames& clip, const DetectionsByName& detections, ClipFacts* facts) {
  Lights lights;
  for (const Frame& frame : clip.frames) {
    const auto found = detections.find(frame.image_name);
    if (found == detections.end()) continue;
    // Not in place: the frames belong to the clip.
    cv::Mat gray;
    if (facts->is_inverted) {
      cv::bitwise_not(frame.gray, gray);
    } else {
      gray = frame.gray;
    }
    for (const MarkerDetection& marker : found->second->markers) {
      const auto light = MeasureLight(gray, marker.corners_in_image_px);
      if (light) lights.Add(marker.marker_id, *light, facts->is_inverted);
    }
  }
  if (lights.blacks.empty()) return;
  CollectPoorLight(lights, facts);
  facts->black = Median(std::move(lights.blacks));
  facts->white = Median(std::move(lights.whites));
  facts->blur_px = Median(std::move(lights.blurs_px));
  facts->motion_px = Median(std::move(lights.motions_px));
}

}  // namespace velamap
