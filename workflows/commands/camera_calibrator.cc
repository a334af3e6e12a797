#include <iostream>
#include <optional>

#include <fmt/format.h>

#include "exporters/calibration/calibration_page.h"
#include "exporters/calibration/calibration_verdict.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "workflows/calibrate/board_calibration.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"

namespace velamap {
namespace {

struct CameraCalibratorCommandOptions : CommandOptions {
  std::string report_path;
  std::string chessboard;
  BoardCalibrationOptions calibration;
};

CommandSyntax Declare(CameraCalibratorCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {
      "camera_calibrator",
      "calibrates a camera from pictures of a board of markers or a chessboard",
      "--image_path board.mp4 --output_path camera.yml",
      {{"Input and output",
        {ImagePathOption(paths),
         Required(PathOption("output_path", PathUse::kWritesOwnFile, &paths->output_path,
                             "camera file for the other commands, with sigmas")),
         BesideIfLeftOut(
             PathOption("report_path", PathUse::kWritesFile, &options->report_path,
                        "web page with the result; left out: beside the camera file, with "
                        "its name, such as camera.html"),
             &paths->output_path, "*.html")}},
       {"Calibration",
        {{"num_views", &options->calibration.calibration.max_num_views, "count",
          "maximum number of pictures used; the most informative ones are chosen", FromTo(5, 500)},
         Common(ChoiceOption("camera_model", &options->calibration.calibration.camera_model,
                             {{std::nullopt, "auto"},
                              {CameraModel::kSimplePinhole, "SIMPLE_PINHOLE"},
                              {CameraModel::kSimpleRadial, "SIMPLE_RADIAL"},
                              {CameraModel::kRadial, "RADIAL"},
                              {CameraModel::kOpenCV, "OPENCV"},
                              {CameraModel::kFullOpenCV, "FULL_OPENCV"},
                              {CameraModel::kOpenCVFisheye, "OPENCV_FISHEYE"}},
                             "auto: the model with the least error in pictures that were left out "
                             "of its fit"))}},
       {"Chessboard",
        {Common({"Board.chessboard", &options->chessboard, "CxR",
                 "a chessboard in place of markers: its inner corners, where four squares meet, as "
                 "columns and rows, such as 9x6"}),
         {"Board.square", &options->calibration.square_m, "m",
          "side of a square; the camera does not depend on it", FromTo(1e-4, 10.0)}}},
       DescribeOptions(&options->markers, true),
       DescribeOptions(&options->calibration.detection),
       DescribeOptions(&options->calibration.video),
       DescribeOptions(&options->general)}};
}

void Validate(CameraCalibratorCommandOptions* options) {
  BoardCalibrationOptions& calibration = options->calibration;
  RefuseVideoOptions(*options);
  calibration.detection.Check();
  calibration.video.Check();
  calibration.image_path = options->paths.image_path;
  calibration.calibration.num_threads = options->general.num_threads;
  calibration.layout = LoadGivenLayout(options->markers, true);
  if (options->typed.count("Board.chessboard") == 0 && options->chessboard.empty()) {
    RefuseOptionsWithoutEffect(options->typed, {"Board."}, "--Board.chessboard is missing");
    return;
  }
  calibration.chessboard = ParseChessboard(options->chessboard, "--Board.chessboard");
  if (calibration.layout) {
    throw InputError(
        "--Board.chessboard: a chessboard has no markers; leave out --layout_path, --dictionary "
        "and --marker_length");
  }
}

void Print(const CameraCalibration& calibration, std::ostream& out) {
  PrintVerdict(JudgeCalibration(calibration), out);
  out << fmt::format("camera: {}\n", DescribeCamera(calibration.camera));
  out << fmt::format("views: {} of {} pictures that show the board\n",
                     calibration.UsedViews().size(), calibration.num_images);
  out << fmt::format("reprojection_error_px: rms {:.4f}, median {:.4f}, max {:.3f}\n",
                     calibration.error_px.rms, calibration.error_px.median,
                     calibration.error_px.max);
  out << fmt::format("outliers_removed: {} of {} corners\n", calibration.num_outliers,
                     calibration.num_outliers + static_cast<int>(calibration.residuals.size()));
  for (const CameraModelScore& score : calibration.scores) {
    out << fmt::format("unseen_error_px: {:.4f} {}\n", score.unseen_error_px,
                       CameraModelName(score.model));
  }
  for (const std::string& advice : AdvisedViews(calibration)) {
    out << fmt::format("shoot_more: {}\n", advice);
  }
  out << fmt::format("board: {}\n", DescribeBoard(calibration.board));
}

// Without its folder: pages are passed on to others.
std::string FileName(const std::string& path) { return AbsoluteFolder(path).filename().string(); }

void Run(const CameraCalibratorCommandOptions& options) {
  const BoardCalibration result = CalibrateWithBoard(options.calibration);
  const CameraCalibration& calibration = result.calibration;
  WriteCalibration(calibration.camera,
                   fmt::format("velamap camera_calibrator: {}, {} pictures, {:.3f} px in pictures "
                               "that it has not seen",
                               CameraModelName(calibration.camera.camera.model),
                               calibration.UsedViews().size(), calibration.Score().unseen_error_px),
                   options.paths.output_path);
  WriteSealedPage(options.report_path, [&](std::ostream& out) {
    WriteCalibrationPage(
        calibration,
        {FileName(options.paths.image_path), FileName(options.paths.output_path), result.board},
        out);
  });
  Print(calibration, std::cout);
  std::cout << fmt::format("camera_path: {}\nreport_path: {}\n", options.paths.output_path,
                           options.report_path);
}

}  // namespace

Command CameraCalibrator() {
  return MakeCommand<CameraCalibratorCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
