#include "importer/camera/calibration_writer.h"

#include <algorithm>
#include <array>
#include <ostream>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/replacement.h"
#include "importer/camera/camera_projection.h"
#include "importer/text/number_text.h"

namespace velamap {
namespace {

// fx, fy, cx, cy and then the distortion, of parameters or of their sigmas.
std::vector<double> WithTwoFocalLengths(CameraModel model, std::vector<double> values) {
  if (HasOneFocalLength(model)) values.insert(values.begin(), values.front());
  return values;
}

// As OpenCV's files have them: 4, or 8 where a rational model needs them.
std::vector<double> Distortion(const std::vector<double>& all) {
  std::vector<double> distortion(all.begin() + 4, all.end());
  distortion.resize(std::max<std::size_t>(distortion.size(), 4), 0.0);
  return distortion;
}

cv::Mat RowOf(const std::vector<double>& values) { return cv::Mat(values, true).reshape(1, 1); }

}  // namespace

double FocalSigma_percent(const EstimatedCamera& found) {
  return 100 * found.sigmas.front() / found.camera.params.front();
}

std::string WhyNotForOtherClips(const EstimatedCamera& found) {
  if (!HasMonotonicDistortion(found.camera)) {
    return "the distortion folds over inside the picture, where no marker was seen; move the "
           "markers through the whole picture";
  }
  const double percent = FocalSigma_percent(found);
  return percent <= kGoodFocalSigma_percent
             ? ""
             : fmt::format("the focal length is known to {:.1f} % only", percent);
}

bool IsHeldAtZero(const EstimatedCamera& estimate, std::size_t index) {
  return estimate.camera.params[index] == 0.0 && estimate.sigmas[index] == 0.0;
}

const char* DistortionName(CameraModel model, std::size_t index) {
  constexpr std::array<const char*, 8> kBrown = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  constexpr std::array<const char*, 4> kFisheye = {"k1", "k2", "k3", "k4"};
  return model == CameraModel::kOpenCVFisheye ? kFisheye.at(index) : kBrown.at(index);
}

std::string CalibrationText(const EstimatedCamera& estimate, const std::string& origin) {
  const Camera& camera = estimate.camera;
  VELAMAP_CHECK(estimate.sigmas.size() == camera.params.size());
  const std::vector<double> params = WithTwoFocalLengths(camera.model, camera.params);
  const std::vector<double> sigmas = WithTwoFocalLengths(camera.model, estimate.sigmas);
  const double cx = params[2] - kImageFromOpenCvPx, cy = params[3] - kImageFromOpenCvPx;
  cv::FileStorage file(
      ".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  file.writeComment(origin);
  file << "image_width" << camera.width_px << "image_height" << camera.height_px;
  file << "camera_matrix" << cv::Mat(cv::Matx33d(params[0], 0, cx, 0, params[1], cy, 0, 0, 1));
  if (camera.model == CameraModel::kOpenCVFisheye)
    file << "distortion_model"
         << "fisheye";
  file << "distortion_coefficients" << RowOf(Distortion(params));
  file << "focal_length_sigma_px" << std::vector<double>{sigmas[0], sigmas[1]};
  file << "principal_point_sigma_px" << std::vector<double>{sigmas[2], sigmas[3]};
  file << "distortion_sigma" << Distortion(sigmas);
  return file.releaseAndGetString();
}

void WriteCalibration(const EstimatedCamera& estimate, const std::string& origin,
                      const std::string& path) {
  const std::string text = CalibrationText(estimate, origin);
  WriteFileAtomically(path, [&text](std::ostream& out) { out << WithSeal(text, "# ", ""); });
}

std::string DescribeCamera(const EstimatedCamera& estimate, std::string_view sign) {
  const Camera& camera = estimate.camera;
  const auto text_of = [&](std::size_t i, int digits) {
    return UncertainText(camera.params[i], estimate.sigmas[i], 1, digits, sign);
  };
  const std::size_t center = NumFocalLengths(camera.model);
  std::string text =
      fmt::format("{}, focal length {}", CameraModelName(camera.model), text_of(0, 1));
  if (center == 2 && text_of(1, 1) != text_of(0, 1)) text += " and " + text_of(1, 1);
  text +=
      fmt::format(" px, principal point ({}, {}) px", text_of(center, 1), text_of(center + 1, 1));
  const char* separator = ", distortion";
  for (std::size_t i = center + 2; i < camera.params.size(); ++i) {
    if (IsHeldAtZero(estimate, i)) continue;
    text += fmt::format("{} {} {}", separator, DistortionName(camera.model, i - center - 2),
                        text_of(i, 4));
    separator = ",";
  }
  return text;
}

}  // namespace velamap
