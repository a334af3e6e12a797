#include "exporters/calibration/calibration_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/camera/camera_projection.h"

namespace velamap {
namespace {

constexpr double kGoodShare = 0.7, kBadShare = 0.3;     // of the picture covered
constexpr std::size_t kManyEmptyParts = 3;              // of nine
constexpr double kGoodSigma = 0.003, kBadSigma = 0.02;  // of the focal length
constexpr double kGoodCenterSigma = 0.003;              // of the picture's larger side
constexpr double kGoodUnseenPx = 0.5, kBadUnseenPx = 2.0;
// If residuals that lie close together share this much of the error, the model lacks something.
constexpr double kMaxPatternShare = 0.6, kMaxPatternPx = 0.05;
constexpr std::size_t kFewViews = 10;
constexpr double kMaxOutliers = 0.1;  // share

// One of the nine parts of a picture.
std::string PartName(int column, int row) {
  constexpr std::array<const char*, 3> kRowNames = {"top", "middle", "bottom"};
  constexpr std::array<const char*, 3> kColumnNames = {"left", "centre", "right"};
  if (row == 1 && column == 1) return "centre";
  return fmt::format("{} {}", kRowNames.at(static_cast<std::size_t>(row)),
                     kColumnNames.at(static_cast<std::size_t>(column)));
}

// The fraction of the picture's cells in which corners were seen.
double CoveredShare(const CameraCalibration& calibration) {
  const std::vector<int> counts =
      CountInCells(calibration.UsedViews(), calibration.Grid(kNumCoverageCells));
  const auto num_covered =
      std::count_if(counts.begin(), counts.end(), [](int count) { return count > 0; });
  return static_cast<double>(num_covered) / static_cast<double>(counts.size());
}

// Parts of the picture in which at least half of the cells are empty.
std::vector<std::string> EmptyParts(const CameraCalibration& calibration) {
  const PictureGrid grid = calibration.Grid(kNumCoverageCells);
  const std::vector<int> counts = CountInCells(calibration.UsedViews(), grid);
  std::array<int, 9> num_cells{}, num_empty{};
  for (int i = 0; i < grid.NumCells(); ++i) {
    const int column = i % grid.num_columns * 3 / grid.num_columns;
    const int row = i / grid.num_columns * 3 / grid.num_rows;
    const auto part = static_cast<std::size_t>(3 * row + column);
    ++num_cells[part];
    num_empty[part] += counts[static_cast<std::size_t>(i)] == 0;
  }
  std::vector<std::string> names;
  for (std::size_t part = 0; part < num_cells.size(); ++part) {
    if (num_cells[part] == 0 || 2 * num_empty[part] < num_cells[part]) continue;
    names.push_back(PartName(static_cast<int>(part) % 3, static_cast<int>(part) / 3));
  }
  return names;
}

// The views with each tilt (BoardView::Tilt).
std::array<std::size_t, BoardView::kNumTilts> CountTilts(const CameraCalibration& calibration) {
  std::array<std::size_t, BoardView::kNumTilts> counts{};
  for (const BoardView& view : calibration.UsedViews()) {
    ++counts[static_cast<std::size_t>(view.Tilt())];
  }
  return counts;
}

class Judge {
 public:
  explicit Judge(const CameraCalibration& calibration) : calibration_(calibration) {}

  Verdict Take() {
    JudgeModel();
    JudgeErrors();
    JudgeSigmas();
    JudgeViews();
    for (const std::string& warning : calibration_.warnings) reasons_.Check(warning);
    return reasons_.Take();
  }

 private:
  // A camera model that the user has chosen can be the wrong one.
  void JudgeModel() {
    constexpr double kMuchBetter = 0.9;
    const CameraModelScore& taken = calibration_.Score();
    const CameraModelScore& best = *std::min_element(
        calibration_.scores.begin(), calibration_.scores.end(),
        [](const CameraModelScore& a, const CameraModelScore& b) {
          return a.is_folded != b.is_folded ? b.is_folded : a.unseen_error_px < b.unseen_error_px;
        });
    if (best.model == taken.model || best.unseen_error_px > kMuchBetter * taken.unseen_error_px) {
      return;
    }
    reasons_.Bad(fmt::format(
        "the residuals are {}: {} leaves {:.2f} px in unseen pictures, {} {:.2f} px; "
        "leave --camera_model out, or take {}",
        best.model == CameraModel::kOpenCVFisheye ? "those of a fisheye lens"
                                                  : "those of another lens",
        CameraModelName(taken.model), taken.unseen_error_px, CameraModelName(best.model),
        best.unseen_error_px, CameraModelName(best.model)));
  }

  void JudgeErrors() {
    const double unseen_px = calibration_.Score().unseen_error_px;
    const std::string text =
        !std::isfinite(unseen_px)
            ? "the pictures are too few to leave some out as a test of the camera: take 20 or more"
            : fmt::format(
                  "the error in unseen pictures is {:.2f} px: hold the board still, in good "
                  "light, and keep it stiff",
                  unseen_px);
    if (unseen_px > kBadUnseenPx) {
      reasons_.Bad(text);
    } else if (unseen_px > kGoodUnseenPx) {
      reasons_.Check(text);
    }
    const double pattern_px = SystematicResidual(
        ResidualsInCells(calibration_.residuals, calibration_.Grid(kNumCoverageCells)));
    if (pattern_px > kMaxPatternPx && pattern_px > kMaxPatternShare * calibration_.error_px.rms) {
      reasons_.Check(
          fmt::format("{:.2f} px of the residuals have a pattern over the picture that no camera "
                      "model explains: was the picture stabilized or corrected by the camera? "
                      "Switch that off",
                      pattern_px));
    }
    const double num_corners =
        static_cast<double>(calibration_.residuals.size()) + calibration_.num_outliers;
    if (calibration_.num_outliers > kMaxOutliers * num_corners) {
      reasons_.Check(
          fmt::format("{:.0f} % of the corners were left out: does the board keep its shape, and "
                      "does each marker appear on it only once?",
                      100.0 * calibration_.num_outliers / num_corners));
    }
  }

  void JudgeSigmas() {
    const EstimatedCamera& found = calibration_.camera;
    const double sigma = found.sigmas[0] / found.camera.params[0];
    const std::string focal = fmt::format(
        "the focal length is known to {:.2f} %: tilt the board by 30 to 45 degrees to "
        "all sides, near and far",
        100.0 * sigma);
    if (sigma > kBadSigma) {
      reasons_.Bad(focal);
    } else if (sigma > kGoodSigma) {
      reasons_.Check(focal);
    }
    const std::size_t center = NumFocalLengths(found.camera.model);
    const double center_px = std::max(found.sigmas[center], found.sigmas[center + 1]);
    const double side_px = LargerSide(found.camera);
    if (center_px > kGoodCenterSigma * side_px) {
      reasons_.Check(
          fmt::format("the principal point is known to {:.1f} px: turn the board by quarters of "
                      "a turn and tilt it to all sides",
                      center_px));
    }
  }

  void JudgeViews() {
    const double share = CoveredShare(calibration_);
    const std::string covered = fmt::format(
        "the board was seen in {:.0f} % of the picture: move it into every corner", 100.0 * share);
    if (share < kBadShare) {
      reasons_.Bad(covered);
    } else if (share < kGoodShare || EmptyParts(calibration_).size() >= kManyEmptyParts) {
      reasons_.Check(covered);
    }
    if (calibration_.UsedViews().size() < kFewViews) {
      reasons_.Check(fmt::format("only {} pictures were used: take {} or more",
                                 calibration_.UsedViews().size(), 2 * kFewViews));
    }
    const auto tilts = CountTilts(calibration_);
    if (tilts[1] + tilts[2] + tilts[3] + tilts[4] < 3) {
      reasons_.Check("the board is hardly ever tilted: tilt it by 30 to 45 degrees to all sides");
    }
  }

  const CameraCalibration& calibration_;
  VerdictReasons reasons_;
};

}  // namespace

Verdict JudgeCalibration(const CameraCalibration& calibration) { return Judge(calibration).Take(); }

std::vector<std::string> AdvisedViews(const CameraCalibration& calibration) {
  std::vector<std::string> advice;
  const std::vector<std::string> parts = EmptyParts(calibration);
  if (!parts.empty()) {
    advice.push_back(fmt::format("the board in these parts of the picture, right to the border: {}",
                                 fmt::join(parts, ", ")));
  }
  const auto tilts = CountTilts(calibration);
  if (tilts[1] == 0) advice.push_back("the board turned about an upright axis, left or right");
  if (tilts[3] == 0) advice.push_back("the board tilted forwards or backwards");
  if (tilts[2] == 0 || tilts[4] == 0) advice.push_back("the board tilted towards its corners");
  if (tilts[0] == 0) advice.push_back("the board straight from the front");
  return advice;
}

std::string DescribeBoard(const BoardFlaws& board) {
  if (!board.is_flat) return "not flat, like a cube or a sail; nothing is wrong with that";
  return fmt::format(
      "bent by {:.3f} +- {:.3f} % of its extent (RMS; at most {:.3f} %), printed {:.2f} +- {:.2f} "
      "% {}, squares scatter by {:.2f} %",
      100.0 * board.bend_m / board.extent_m, 100.0 * board.bend_sigma_m / board.extent_m,
      100.0 * board.max_bend_m / board.extent_m, 100.0 * std::abs(board.stretch),
      100.0 * board.stretch_sigma, board.stretch < 0 ? "too narrow" : "too wide",
      100.0 * board.size_scatter);
}

}  // namespace velamap
