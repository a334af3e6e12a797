#include "workflows/check/clip_verdict.h"

#include <algorithm>

#include <fmt/format.h>

#include "exporters/report/camera_key_numbers.h"
#include "importer/text/id_ranges.h"
#include "reconstruct/model/weak_geometry.h"
#include "workflows/check/clip_limits.h"

namespace velamap {
namespace {

constexpr double kMaxBlurPx = 1.5, kMaxMotionPx = 4.0;
constexpr double kMaxShareInPoorLight = 0.1;
constexpr double kMaxShareWithFewMarkers = 0.3;
constexpr int kRarelySeen = 3;

constexpr char kLargerMarkers[] = "go closer, film at a higher resolution, or print larger markers";

std::string SmallMarkersText(const ClipFacts& facts) {
  return fmt::format("half of the markers are smaller than {:.1f} px", facts.side_px.median);
}

class Judge {
 public:
  explicit Judge(const ClipFacts& facts) : facts_(facts) {}

  Verdict Take() {
    JudgeDictionary();
    JudgeMirroring();
    JudgeIds();
    JudgeSize();
    JudgeLight();
    JudgeFrames();
    JudgePrecision();
    JudgeLayout();
    return reasons_.Take();
  }

 private:
  void JudgeDictionary() {
    if (facts_.num_frames_of_id.empty()) {
      reasons_.Bad(facts_.no_markers_because.empty()
                       ? "no marker is seen: check that the clip shows markers, and the dictionary"
                       : "the markers cannot be judged: " + facts_.no_markers_because);
      return;
    }
    if (facts_.num_markers_found && facts_.num_markers_of_second &&
        2 * *facts_.num_markers_of_second > *facts_.num_markers_found) {
      reasons_.Bad(
          fmt::format("{} and {} find about as many markers: name the dictionary of the "
                      "print with --dictionary, and the side of its markers with --marker_length",
                      facts_.dictionary, facts_.second_dictionary));
    }
  }

  void JudgeMirroring() {
    if (facts_.ids_mirrored.empty()) return;
    reasons_.Bad(fmt::format(
        "{} markers are found only in the mirrored image, so the clip is mirrored, as by a "
        "phone's front camera; switch mirroring off, or turn it back (ffmpeg -i clip.mp4 -vf hflip "
        "turned.mp4)",
        facts_.ids_mirrored.size()));
  }

  void JudgeIds() {
    if (facts_.num_frames_of_id.empty()) return;
    const std::size_t num_missing = facts_.ids_never_seen.size();
    if (facts_.MissesMostMarkers() && facts_.ids_mirrored.empty()) {
      reasons_.Bad(fmt::format(
          "{} of {} markers of the layout are never seen: the layout or the dictionary does not "
          "belong to these pictures: give those of this object, or film all of it",
          num_missing, num_missing + facts_.num_frames_of_id.size()));
    } else {
      JudgeUnseen();
    }
    std::vector<int> rare;
    for (const auto& [marker_id, num_frames] : facts_.num_frames_of_id) {
      if (num_frames < kRarelySeen) rare.push_back(marker_id);
    }
    if (facts_.has_layout && !rare.empty() && facts_.num_frames_read >= 4 * kRarelySeen) {
      reasons_.Check(fmt::format("seen in fewer than {} of {} frames: {}: film them longer",
                                 kRarelySeen, facts_.num_frames_read, IdRanges(rare)));
    }
    if (!facts_.ids_not_in_layout.empty()) {
      reasons_.Check(fmt::format("not in the layout: {}: add them, or take them off the object",
                                 IdRanges(facts_.ids_not_in_layout)));
    }
  }

  // If the camera has seen the markers on both sides, filming longer does not help.
  void JudgeUnseen() {
    const std::vector<int>& between = facts_.ids_unseen_between_seen;
    std::vector<int> others;
    for (const int marker_id : facts_.ids_never_seen) {
      if (std::count(between.begin(), between.end(), marker_id) == 0) others.push_back(marker_id);
    }
    if (!between.empty()) {
      reasons_.Check(fmt::format(
          "{} {} never found: {}: look for glare, shadow or something in front of them; remove "
          "from the layout what is not there",
          between.size(),
          between.size() == 1 ? "marker between seen ones is" : "markers between seen ones are",
          IdRanges(between)));
    }
    if (others.empty()) return;
    reasons_.Check(
        fmt::format("never seen: {}: film them, or remove them from the layout", IdRanges(others)));
  }

  void JudgeSize() {
    if (facts_.side_px.count == 0) return;
    if (facts_.side_px.median < kBadSidePx) {
      reasons_.Bad(fmt::format("{}: {}", SmallMarkersText(facts_), kLargerMarkers));
    }
  }

  void JudgeLight() {
    if (!facts_.white) return;
    if (*facts_.white > kMaxWhite) {
      reasons_.Check("the paper is overexposed, which moves edges: reduce the exposure");
    }
    if (*facts_.white - *facts_.black < kGoodContrast) {
      reasons_.Check(
          fmt::format("black and white differ by {:.0f} of 255 grey levels: increase the "
                      "exposure, avoid glare",
                      *facts_.white - *facts_.black));
    } else if (*facts_.white <= kMaxWhite && facts_.poor_light_share > kMaxShareInPoorLight) {
      reasons_.Check(fmt::format(
          "{:.0f} % of the markers are overexposed or pale{}: avoid glare, film from another side "
          "or without direct sun",
          100 * facts_.poor_light_share,
          facts_.ids_in_poor_light.empty() ? ""
                                           : ", mostly " + IdRanges(facts_.ids_in_poor_light)));
    }
    if (*facts_.motion_px > kMaxMotionPx) {
      reasons_.Check(
          fmt::format("markers move by {:.0f} px during the exposure: use a shorter shutter",
                      *facts_.motion_px));
    }
    if (*facts_.blur_px > kMaxBlurPx) {
      reasons_.Check(
          fmt::format("edges are blurred by {:.1f} px (1 sigma): focus, clean the lens, use less "
                      "compression",
                      *facts_.blur_px));
    }
  }

  void JudgeFrames() {
    if (facts_.num_frames_damaged > 0) {
      reasons_.Check(fmt::format(
          "{} of {} frames looked at are damaged in the file and left out: copy it from the camera "
          "again, or film again",
          facts_.num_frames_damaged, facts_.num_frames_damaged + facts_.num_frames_read));
    }
    if (facts_.num_frames_of_id.empty()) return;
    const double share =
        static_cast<double>(facts_.num_frames_with_few_markers) / facts_.num_frames_read;
    if (share > kMaxShareWithFewMarkers) {
      reasons_.Check(
          fmt::format("{:.0f} % of the frames show fewer than four markers: keep the object in "
                      "the picture",
                      100 * share));
    }
  }

  void JudgeWithoutPrecision() {
    if (facts_.shows_one_picture) {
      reasons_.Bad(
          "all frames with markers show the same picture, which does not determine depth: film "
          "again, and move the camera around the object");
      return;
    }
    if (facts_.LacksSizes()) {
      reasons_.Check(
          "depth, zoom and stabilization are not checked without the markers' sizes: give "
          "--layout_path, or --dictionary and --marker_length");
    }
    if (facts_.num_frames_of_id.empty() || facts_.no_precision_because.empty()) return;
    const bool may_be_calibration =
        facts_.has_camera && !IsWeakGeometryWarning(facts_.no_precision_because);
    reasons_.Bad(fmt::format(
        "no shape can be reconstructed from these frames: {}{}", facts_.no_precision_because,
        may_be_calibration ? "; the calibration may be of another camera, lens mode or zoom: check "
                             "it, too"
                           : ""));
  }

  void JudgePrecision() {
    if (!facts_.precision) return JudgeWithoutPrecision();
    const ClipPrecision& precision = *facts_.precision;
    JudgeAgreement(precision);
    const std::string text =
        fmt::format("the camera moves {:.0f} degrees around the object", precision.parallax_deg);
    const std::string remedy = "move sideways by a third of the distance or more";
    if (precision.parallax_deg < kBadParallax_deg) {
      reasons_.Bad(text + ", which is too little to determine depth: " + remedy);
    } else if (precision.parallax_deg < kGoodParallax_deg) {
      reasons_.Check(text + ", which makes depth less certain than width: " + remedy);
    }
    for (const std::string& marker : precision.markers_left_out) {
      reasons_.Check("contradicts the layout: " + marker);
    }
    for (const std::string& warning : precision.warnings) {
      const bool says_it_again =
          precision.parallax_deg < kGoodParallax_deg && IsWeakGeometryWarning(warning);
      if (warning != camera_advice_ && !says_it_again) reasons_.Check(warning);
    }
    JudgeSteadiness(precision.steadiness);
  }

  // A wrong camera leaves few markers and images that agree, whose residuals prove little.
  void JudgeAgreement(const ClipPrecision& precision) {
    constexpr int kManyMarkers = 8;
    const auto num_seen = static_cast<int>(
        std::count_if(facts_.num_frames_of_id.begin(), facts_.num_frames_of_id.end(),
                      [](const auto& id_and_num) { return id_and_num.second >= kRarelySeen; }));
    const int num_frames = facts_.num_frames_read - facts_.num_frames_with_few_markers;
    if (num_seen >= kManyMarkers &&
        (2 * precision.num_markers < num_seen || 2 * precision.num_images < num_frames)) {
      reasons_.Bad(fmt::format(
          "only {} of {} markers in {} of {} frames fit together: {}", precision.num_markers,
          num_seen, precision.num_images, num_frames,
          facts_.has_camera
              ? "the calibration does not belong to these images (another camera, lens mode or "
                "zoom), or the surface moved: calibrate this camera as it filmed (velamap "
                "camera_calibrator)"
              : "the surface moved, or the lens was zoomed: film again with both still, or give "
                "--camera_path"));
      return;
    }
    JudgeCamera(precision);
  }

  void JudgeCamera(const ClipPrecision& precision) {
    const ReportStatus status = StatusOf(precision.calibration);
    if (status > ReportStatus::kGood) {
      camera_advice_ = facts_.has_camera ? CalibrationAdvice(precision.calibration)
                                         : FoundCameraAdvice(precision.warnings);
      reasons_.Add(status, camera_advice_);
    }
    const auto found = FoundCameraNumber(precision.found_cameras);
    if (found && found->status > ReportStatus::kGood) {
      reasons_.Add(found->status, fmt::format("camera {}; {}", found->value, found->advice));
    }
  }

  void JudgeSteadiness(const SteadinessVerdict& steadiness) {
    const auto level = [](bool spoils_shape) {
      return spoils_shape ? ReportStatus::kBad : ReportStatus::kCheck;
    };
    if (const auto& wander = steadiness.wander) {
      reasons_.Add(level(wander->SpoilsShape()), DescribeWander(*wander));
    } else if (const auto& step = steadiness.step; step && facts_.has_camera) {
      reasons_.Add(level(step->SpoilsShape()), DescribeStep(*step));
    }
    if (steadiness.step && !facts_.has_camera) {
      // No camera explains both settings, so a reconstruction ends here.
      reasons_.Bad("the camera cannot be found: " + DescribeStep(*steadiness.step));
    }
  }

  void JudgeLayout() {
    for (const std::string& contradiction : facts_.contradictions) reasons_.Check(contradiction);
    if (!facts_.no_proposal_because.empty()) {
      reasons_.Check("no layout can be proposed: " + facts_.no_proposal_because);
    }
  }

  const ClipFacts& facts_;
  std::string camera_advice_;  // may repeat a warning
  VerdictReasons reasons_;
};

}  // namespace

Verdict JudgeClip(const ClipFacts& facts) { return Judge(facts).Take(); }

std::string SizeHint(const ClipFacts& facts) {
  const double side_px = facts.side_px.count == 0 ? 0.0 : facts.side_px.median;
  if (side_px < kBadSidePx || side_px >= kGoodSidePx) return "";
  // The reconstruction of these frames is more reliable than the rule of thumb.
  const std::string size =
      facts.precision ? fmt::format("the size is known to {:.2f} % (1 sigma) from these frames",
                                    100 * facts.precision->scale_sigma)
                      : "the size may be known only to a few tenths of a percent";
  return fmt::format(
      "{}, and below {:.0f} px more and more are lost; {}; for more markers and a better size, {}",
      SmallMarkersText(facts), kBadSidePx, size, kLargerMarkers);
}

}  // namespace velamap
