#include "reconstruct/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/camera/turned_camera.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/camera/lens_bend_correction.h"
#include "reconstruct/camera_search.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"

namespace velamap {
namespace {

// Throws DataError unless one camera, rotated or not, can have taken all pictures.
void CheckOneCamera(const std::map<CameraId, Camera>& guesses) {
  for (const auto& [camera_id, camera] : guesses) {
    const Camera& first = guesses.begin()->second;
    if (camera == first || camera == TurnCamera(first, 1) || TurnCamera(camera, 1) == first) {
      continue;
    }
    throw DataError(fmt::format(
        "the pictures come from more than one camera or zoom: {} x {} and {} x {} px, and focal "
        "lengths of about {:.0f} and {:.0f} px by EXIF or size; calibrate each one separately",
        first.width_px, first.height_px, camera.width_px, camera.height_px, MeanFocalLength(first),
        MeanFocalLength(camera)));
  }
}

// Throws DataError if no part of the board is in two pictures, or none moves between them.
void CheckMovement(const std::vector<DatabaseImage>& images, const Camera& guess) {
  constexpr double kLeastMovement = 0.03;  // of the larger side
  constexpr char kRemedy[] =
      "move the board through the whole picture, near and far, and tilt it by 30 to 45 degrees to "
      "all sides";
  std::map<CornerId, Eigen::AlignedBox2d> places_px;
  std::set<CornerId> seen_twice;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) {
      for (int c = 1; c <= kNumCorners; ++c) {
        const CornerId corner_id{marker.marker_id, c};
        const auto [place, is_new] = places_px.try_emplace(corner_id);
        if (!is_new) seen_twice.insert(corner_id);
        place->second.extend(marker.corners_in_image_px[static_cast<std::size_t>(c) - 1]);
      }
    }
  }
  if (seen_twice.empty()) {
    throw DataError(fmt::format("no marker is in two of the pictures, of which {} can be used; {}",
                                images.size(), kRemedy));
  }
  double largest_px = 0.0;
  for (const auto& [corner_id, box] : places_px) {
    largest_px = std::max(largest_px, box.diagonal().norm());
  }
  if (largest_px >= kLeastMovement * LargerSide(guess)) return;
  throw DataError(fmt::format("all {} pictures are alike: nothing moves by more than {:.0f} px; {}",
                              images.size(), largest_px, kRemedy));
}

// The images with the corners in the pixels of the first camera: pictures of the rotated camera are
// turned back, as UprightCameras() of the camera search does.
std::vector<DatabaseImage> Upright(std::vector<DatabaseImage> images,
                                   const std::map<CameraId, Camera>& guesses) {
  for (DatabaseImage& image : images) {
    const Camera& camera = guesses.at(image.camera_id);
    if (camera == guesses.begin()->second) continue;
    for (MarkerDetection& marker : image.detections.markers) {
      for (Eigen::Vector2d& corner_px : marker.corners_in_image_px) {
        corner_px = TurnInImage(camera, -1, corner_px);
      }
    }
  }
  return images;
}

void ChooseCalibrationViews(const std::vector<DatabaseImage>& upright, const Camera& guess,
                            double corner_sigma_px, int max_num_views,
                            CameraCalibration* calibration) {
  constexpr double kRepeated = 5e-4;  // of the larger side
  const std::vector<BoardView> views = WithoutRepeatedViews(
      DescribeBoardViews(upright, corner_sigma_px), kRepeated * LargerSide(guess));
  calibration->num_images = static_cast<int>(views.size());
  const PictureGrid grid = MakePictureGrid(guess.width_px, guess.height_px, kNumCoverageCells);
  for (const std::size_t idx : ChooseBoardViews(views, grid, max_num_views)) {
    calibration->views.push_back({views[idx]});
  }
}

std::vector<DatabaseImage> ChosenImages(const std::vector<DatabaseImage>& images,
                                        const std::vector<CalibrationView>& views) {
  std::set<ImageId> image_ids;
  for (const CalibrationView& view : views) image_ids.insert(view.view.image_id);
  std::vector<DatabaseImage> chosen;
  for (const DatabaseImage& image : images) {
    if (image_ids.count(image.image_id) > 0) chosen.push_back(image);
  }
  return chosen;
}

// Paper can stretch by some tenths of a percent, and cardboard bends, so the prior of square and
// flat markers is weak. The scale that the markers give does not affect a camera.
MarkerAdjustmentOptions BoardOptions(int num_threads) {
  constexpr double kSquareSigma = 0.01, kFlatness = 0.02;  // of a side
  MarkerAdjustmentOptions options;
  options.print_tolerance = kSquareSigma;
  options.cloth_flatness = options.rigid_flatness = kFlatness;
  options.num_threads = num_threads;
  return options;
}

// Throws DataError if the focal length changes between two pictures. `seed` is the model before its
// adjustment.
void CheckSteadiness(const MarkerAdjustmentOptions& options, const Layout& layout,
                     const CornerErrors& corner_errors, const Model& seed, const Model& adjusted,
                     std::vector<std::string>* warnings) {
  const SteadinessVerdict verdict = JudgeSteadiness(adjusted);
  if (verdict.wander) warnings->push_back(DescribeWander(*verdict.wander));
  const auto step = ConfirmFocalStep(options, layout, corner_errors, &seed, verdict.step);
  if (step) throw DataError("the camera cannot be calibrated: " + DescribeStep(*step));
}

// Throws DataError if the pictures that are not in the model have another focal length, by their
// markers alone: more than five sigmas and more than the focus of a lens changes it. With a zoom of
// 1.3 and more, pictures of one setting fit no pose among those of the other.
void CheckLeftOut(const MarkerAdjustmentOptions& options, const std::vector<DatabaseImage>& upright,
                  const Camera& guess, const Model& model) {
  constexpr std::size_t kMinImages = 3;
  constexpr double kMinSigmas = 5.0, kMinChange = 0.05;
  std::vector<DatabaseImage> before, after;
  FocalStep step;
  for (const DatabaseImage& image : upright) {
    const bool is_used = model.FindImage(image.image_id) != nullptr;
    (is_used ? before : after).push_back(image);
    (is_used ? step.image_ids_before : step.image_ids_after).insert(image.image_id);
  }
  if (after.size() < kMinImages) return;
  const auto find = [&](const std::vector<DatabaseImage>& images) {
    return FindFocalLength(CameraModel::kSimpleRadial, guess.width_px, guess.height_px,
                           SquaresOf(images, options), options.num_threads);
  };
  const FocalEvidence first = find(before), second = find(after);
  step.before_px = MeanFocalLength(first.camera);
  step.after_px = MeanFocalLength(second.camera);
  step.first_image_after = after.front().detections.image_name;
  const double change = std::abs(std::log(step.after_px / step.before_px));
  const double sigma = std::hypot(first.log_sigma, second.log_sigma);
  LogDebug("{} pictures left out: focal length {:.0f} px instead of {:.0f} px, {:.1f} sigmas",
           after.size(), step.after_px, step.before_px, change / sigma);
  if (change > kMinChange && change > kMinSigmas * sigma) {
    throw DataError("the camera cannot be calibrated: " + DescribeStep(step));
  }
}

void CollectResiduals(const Model& model, CameraCalibration* calibration) {
  std::map<ImageId, std::vector<double>> errors_px;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    const ModelImage& image = *model.FindImage(error.element.image_id);
    const Eigen::Vector2d& x_px = image.points2D[error.element.point2D_idx].x_in_image_px;
    calibration->residuals.push_back({x_px, error.residual_in_image_px});
    errors_px[image.image_id].push_back(error.error_px);
  }
  for (CalibrationView& view : calibration->views) {
    const auto found = errors_px.find(view.view.image_id);
    if (found == errors_px.end()) continue;
    view.is_used = true;
    view.error_px = Rms(found->second);
    // Takes the corners from the adjusted model, in which rotated pictures are upright.
    view.view.corners_in_image_px.clear();
    for (const SeenPoint& point : SeenPointsOf(model, *model.FindImage(view.view.image_id))) {
      view.view.corners_in_image_px.push_back(point.x_in_image_px);
    }
  }
}

void TakeResult(CalibrationAdjustment adjusted, CameraCalibration* calibration) {
  const AdjustmentUncertainty& uncertainty = adjusted.summary.uncertainty;
  calibration->camera = adjusted.summary.cameras.begin()->second;
  calibration->scores = std::move(adjusted.scores);
  calibration->num_outliers = static_cast<int>(adjusted.summary.removed.size());
  calibration->error_px = adjusted.summary.error_after_px;
  calibration->rolling_shutter_s = uncertainty.rolling_shutter_s;
  calibration->rolling_shutter_sigma_s = uncertainty.rolling_shutter_sigma_s;
  calibration->board = FindBoardFlaws(adjusted.model, uncertainty.points);
  CollectResiduals(adjusted.model, calibration);
}

}  // namespace

const CameraModelScore& CameraCalibration::Score() const {
  const auto found = std::find_if(
      scores.begin(), scores.end(),
      [this](const CameraModelScore& score) { return score.model == camera.camera.model; });
  VELAMAP_CHECK(found != scores.end());
  return *found;
}

std::vector<BoardView> CameraCalibration::UsedViews() const {
  std::vector<BoardView> used;
  for (const CalibrationView& view : views) {
    if (view.is_used) used.push_back(view.view);
  }
  return used;
}

PictureGrid CameraCalibration::Grid(int num_cells) const {
  return MakePictureGrid(camera.camera.width_px, camera.camera.height_px, num_cells);
}

CameraCalibration CalibrateCamera(const CameraCalibrationOptions& options,
                                  const std::vector<DatabaseImage>& images,
                                  const std::map<CameraId, Camera>& guesses, const Layout& layout,
                                  const std::optional<FormationEstimate>& formation) {
  CheckOneCamera(guesses);
  const Camera& guess = guesses.begin()->second;
  CheckMovement(images, guess);
  const MarkerAdjustmentOptions adjustment = BoardOptions(options.num_threads);
  CameraCalibration calibration;
  ChooseCalibrationViews(Upright(images, guesses), guess, adjustment.corner_sigma_px,
                         options.max_num_views, &calibration);
  std::vector<DatabaseImage> used = ChosenImages(images, calibration.views);
  LogInfo("{} of {} pictures that show the board are chosen", used.size(), images.size());
  // Takes all images and not only the selected ones, because the velocity of a corner follows from
  // the neighbouring frames.
  const CornerErrors corner_errors = CornerErrorsOf(images, formation);
  RegistrationOptions registration_options;
  registration_options.num_threads = options.num_threads;
  registration_options.has_calibration = false;
  const std::map<CameraId, Camera> cameras =
      FindCameras(used, guesses, layout, corner_errors, registration_options, adjustment);
  CorrectForLensBend(cameras, &used);
  const Registration registration = RegisterFrames(used, cameras, layout, registration_options);
  const Model seed = MakeSeedModel(registration, used, cameras);
  CalibrationAdjustment adjusted =
      AdjustForCalibration(adjustment, layout, corner_errors, seed, options.camera_model);
  calibration.warnings = std::move(adjusted.summary.warnings);
  CheckSteadiness(adjustment, layout, corner_errors, seed, adjusted.model, &calibration.warnings);
  CheckLeftOut(adjustment, Upright(used, guesses), guess, adjusted.model);
  TakeResult(std::move(adjusted), &calibration);
  return calibration;
}

}  // namespace velamap
