#include "importer/formation/formation_sampling.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/base/log.h"
#include "importer/base/parallel.h"
#include "importer/detect/marker_alignment.h"
#include "importer/detect/search_regions.h"
#include "importer/refine/read_again.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

// Smaller markers show too little of their cells. Those below kGoodSidePx are used where there are
// hardly any others.
constexpr double kMinSidePx = 9.0, kGoodSidePx = 12.0;
constexpr int kUsualFits = 60;        // of each sample; nine inputs took 40 to 70
constexpr double kBestSidePx = 40.0;  // fits of larger markers take longer and add nothing

// Sorts the most informative markers first, those whose size is nearest to kBestSidePx. A Marker
// has `corners_px`.
template <typename Marker>
void SortByPreference(std::vector<Marker>* markers) {
  const auto preference = [](const Marker& marker) {
    const double side_px = QuadMeanSide(marker.corners_px);
    return std::min(side_px / kBestSidePx, kBestSidePx / side_px);
  };
  std::stable_sort(markers->begin(), markers->end(),
                   [&](const Marker& a, const Marker& b) { return preference(a) > preference(b); });
}

template <typename Marker>
std::size_t CountGood(const std::vector<Marker>& markers) {
  return static_cast<std::size_t>(std::count_if(
      markers.begin(), markers.end(),
      [](const Marker& marker) { return QuadMeanSide(marker.corners_px) >= kGoodSidePx; }));
}

// The number of samples per frame. Each small marker contributes less information and takes less
// time, so the number follows from a total number of pixels.
struct SampleQuota {
  int num_large = 0;  // always taken
  int num_small = 0;  // at most
  double num_pixels = 0.0;
};
constexpr SampleQuota kQuota = {32, 128, 6e5};  // of all frames

SampleQuota QuotaOfFrame(int num_frames) {
  return {std::max(1, kQuota.num_large / num_frames), std::max(1, kQuota.num_small / num_frames),
          kQuota.num_pixels / num_frames};
}

// How far a sample reaches beyond the marker.
double SampleReachPx(double side_px) { return 0.6 * side_px + 8; }

// Chooses markers of the layout, spread over the half of the good ones whose size is nearest to
// kBestSidePx.
std::vector<MarkerQuad> ChooseMarkers(const FrameDetector& detector, const SampleQuota& quota,
                                      std::vector<MarkerQuad> quads) {
  quads.erase(std::remove_if(quads.begin(), quads.end(),
                             [&](const MarkerQuad& quad) {
                               return QuadMeanSide(quad.corners_px) < kMinSidePx ||
                                      (!detector.part_of_id.empty() &&
                                       detector.part_of_id.count(quad.marker_id) == 0);
                             }),
              quads.end());
  SortByPreference(&quads);
  if (quads.empty()) return {};
  const auto size = static_cast<int>(quads.size());
  const double side_px = QuadMeanSide(quads[quads.size() / 4].corners_px);
  const double width_px = side_px + 2 * SampleReachPx(side_px);
  const auto num_that_fit = static_cast<int>(quota.num_pixels / (width_px * width_px));
  const int num = std::min(size, std::clamp(num_that_fit, quota.num_large, quota.num_small));
  const int num_good = std::max(num, static_cast<int>(CountGood(quads) / 2));
  std::vector<MarkerQuad> chosen;
  for (int i = 0; i < num; ++i) {
    chosen.push_back(quads[static_cast<std::size_t>(i * num_good / num)]);
  }
  return chosen;
}

// Leaves out the largest samples beyond a total of kMaxPixels, because the estimate holds all
// samples many times over.
void LimitPixels(std::vector<FormationSample>* samples) {
  constexpr std::size_t kMaxPixels = 6'000'000, kAlways = 4;
  std::stable_sort(samples->begin(), samples->end(),
                   [](const FormationSample& a, const FormationSample& b) {
                     return a.gray.total() < b.gray.total();
                   });
  std::size_t num_pixels = 0, num_kept = 0;
  for (const FormationSample& sample : *samples) {
    num_pixels += sample.gray.total();
    if (num_kept >= kAlways && num_pixels > kMaxPixels) break;
    ++num_kept;
  }
  samples->resize(num_kept);
}

// Returns the marker with its surroundings; nothing if its sides are not found. Its code is read
// again, because a misread code would imply edges that are not there.
std::optional<FormationSample> CutSample(const FrameDetector& detector, const Camera& camera,
                                         const cv::Mat& gray, const MarkerQuad& found) {
  const cv::Rect cut = PixelsAround(BoundingBox(found.corners_px), gray.size(),
                                    SampleReachPx(QuadMeanSide(found.corners_px)));
  FormationSample sample;
  sample.gray = gray(cut).clone();
  if (detector.options.inverted) cv::bitwise_not(sample.gray, sample.gray);
  const Eigen::Vector2d offset_px(cut.x, cut.y);
  MarkerQuad quad = found;
  for (Eigen::Vector2d& corner_px : quad.corners_px) corner_px -= offset_px;
  quad = RefineAndReadAgain(sample.gray, quad, detector.dictionary, detector.border_bits,
                            ImageFormation(), detector.sides_mm)
             .quad;
  MarkerQuad in_frame = quad;
  for (Eigen::Vector2d& corner_px : in_frame.corners_px) corner_px += offset_px;
  sample.marker = KnownMarkerAt(in_frame, detector.dictionary, detector.border_bits,
                                detector.sides_mm, &camera);
  const auto aligned = AlignSides(sample.gray, quad.corners_px, {sample.marker.cells});
  if (!aligned) return std::nullopt;
  sample.corners_px = *aligned;
  return sample;
}

std::vector<FormationSample> CutSamples(const FrameDetector& detector, const Camera& camera,
                                        const cv::Mat& gray, const SampleQuota& quota) {
  std::vector<FormationSample> samples;
  for (const MarkerQuad& quad : ChooseMarkers(detector, quota, SearchInFrame(detector, gray))) {
    auto sample = CutSample(detector, camera, gray, quad);
    if (sample) samples.push_back(std::move(*sample));
  }
  return samples;
}

// Where samples come from.
struct SampledSource {
  const FrameDetector& detector;
  const std::function<Camera(const Frame&)>& camera_of;
  int num_threads;
  std::function<void()> count;  // called after each frame; may be empty
  FrameSource* frames;
};

constexpr int kMaxPhotographs = 32;

int StrideOfPhotographs(int num_images) {
  return std::max(1, (num_images + kMaxPhotographs - 1) / kMaxPhotographs);
}

// Calls `progress` with one more of `total` at each call, from any thread.
std::function<void()> Counter(const ProgressCallback& progress, int total) {
  if (!progress) return {};
  progress(0, total, "");
  const auto count = std::make_shared<std::atomic<int>>(0);
  return [=] { progress(++*count, total, ""); };
}

// Reads `num_frames` frames, every `stride`-th, and cuts samples from them. False at the end.
bool SampleFrames(const SampledSource& source, int num_frames, int stride, const SampleQuota& quota,
                  std::vector<FormationSample>* samples) {
  std::vector<Frame> frames;  // without pixels
  bool has_more = true;
  for (int idx = 0; static_cast<int>(frames.size()) < num_frames && has_more; ++idx) {
    std::optional<Frame> frame = source.frames->Next();
    has_more = frame.has_value();
    if (has_more && idx % stride == 0) frames.push_back(std::move(*frame));
  }
  std::vector<std::vector<FormationSample>> samples_of(frames.size());
  ParallelFor(frames.size(), source.num_threads, [&](std::size_t i) {
    Frame frame = std::move(frames[i]);
    std::string reason;
    if (source.frames->Load(&frame, &reason)) {
      samples_of[i] = CutSamples(source.detector, source.camera_of(frame), frame.gray, quota);
    }
    if (source.count) source.count();
  });
  for (std::vector<FormationSample>& some : samples_of) {
    std::move(some.begin(), some.end(), std::back_inserter(*samples));
  }
  return has_more;
}

// Samples frames at the beginning of a video. Adds later frames, farther and farther apart, while
// too few good markers are found, and continues to the end of the video if there are hardly any
// markers. In a short video the frames are closer together.
std::vector<FormationSample> SampleVideo(const SampledSource& source) {
  constexpr int kNumFrames = 8, kStride = 5, kMaxStride = 160;
  constexpr std::size_t kEnough = kQuota.num_large / 2;
  const int num_in_video = source.frames->NumFrames();  // 0: unknown
  const int first_stride =
      num_in_video == 0 ? kStride : std::clamp(num_in_video / kNumFrames, 1, kStride);
  std::vector<FormationSample> samples;
  bool has_more = true;
  for (int stride = first_stride; has_more; stride = std::min(2 * stride, kMaxStride)) {
    has_more = SampleFrames(source, kNumFrames, stride, QuotaOfFrame(kNumFrames), &samples);
    const bool is_last_resort = stride == kMaxStride;
    if (CountGood(samples) >= (is_last_resort ? kMinFormationSamples : kEnough)) break;
    if (is_last_resort && samples.size() >= std::size_t{kQuota.num_large}) break;
  }
  if (CountGood(samples) < kEnough) {
    SortByPreference(&samples);
    samples.resize(std::min(samples.size(), std::size_t{kQuota.num_small}));
  }
  return samples;
}

// Samples all photographs if there are at most kMaxPhotographs, otherwise every k-th in the order
// of their names.
std::vector<FormationSample> SamplePhotographs(const SampledSource& source) {
  const int num_images = std::max(1, source.frames->NumFrames());
  std::vector<FormationSample> samples;
  SampleFrames(source, kMaxPhotographs, StrideOfPhotographs(num_images),
               QuotaOfFrame(std::min(num_images, kMaxPhotographs)), &samples);
  return samples;
}

}  // namespace

FormationEstimate EstimateFormationOfSource(const std::string& image_path,
                                            const VideoOptions& video, int num_threads,
                                            const FrameDetector& detector,
                                            const std::function<Camera(const Frame&)>& camera_of,
                                            const FormationProgress& progress) {
  // May take longer than the detection in a few photographs.
  LogInfo("looking for markers that show what camera and print do to edges");
  const std::unique_ptr<FrameSource> frames = OpenFrameSource(image_path, video, {}, num_threads);
  const int stride = StrideOfPhotographs(frames->NumFrames());
  const int num_sampled = frames->IsVideo() ? 0 : (frames->NumFrames() + stride - 1) / stride;
  const SampledSource source{detector, camera_of, num_threads,
                             Counter(progress.frames, num_sampled), frames.get()};
  std::vector<FormationSample> samples =
      frames->IsVideo() ? SampleVideo(source) : SamplePhotographs(source);
  LimitPixels(&samples);
  // Sums in single precision depend on their order, which the names of photographs decide.
  const auto key = [](const FormationSample& sample) {
    return std::make_pair(cv::sum(sample.gray)[0], sample.corners_px[0].sum());
  };
  std::sort(samples.begin(), samples.end(),
            [&](const FormationSample& a, const FormationSample& b) { return key(a) < key(b); });
  if (samples.size() >= kMinFormationSamples) {
    LogInfo("estimating how camera and print change the edges of {} markers", samples.size());
  }
  const FormationEstimate estimate = EstimateFormation(
      samples, detector.options.inverted,
      {num_threads, Counter(progress.fits, kUsualFits * static_cast<int>(samples.size()))});
  if (estimate.num_samples == 0) {
    LogWarning(
        "{}: too few markers are large and sharp enough to show what the camera does to edges; its "
        "grey values are taken to be proportional to light, which may move each corner by {:.1f} "
        "px",
        image_path, estimate.inset_sigma_px);
    return estimate;
  }
  const ImageFormationParameters& found = estimate.parameters;
  LogInfo(
      "camera and print, from {} markers: halo {:+.3f} over {:.1f} px, gamma {:.2f}, S-curve "
      "{:+.3f}, sharpening {:.2f} over {:.1f} px, ink spread {:+.3f} mm, edges moved by "
      "{:+.2f} and outlines by {:+.2f} blur sigmas, quiet zone {:.2f} cells; residuals {:.1f} grey "
      "levels",
      estimate.num_samples, found.halo, found.halo_radius_px, found.gamma, found.s_amplitude,
      found.sharpening, found.sharpening_radius_px, found.ink_spread_mm, found.edge_shift_blurs,
      found.outline_shift_blurs, found.quiet_zone_cells, estimate.noise_gray);
  return estimate;
}

}  // namespace velamap
