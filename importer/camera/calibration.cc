#include "importer/camera/calibration.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/camera/camera_projection.h"
#include "importer/camera/storage_reader.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

constexpr int kMaxImageSize = 100000;

[[noreturn]] void Fail(const std::string& path, const std::string& message) {
  throw InputError(fmt::format("{}: {}", path, message));
}

bool AllZero(const std::vector<double>& values, std::size_t begin) {
  return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(std::min(begin, values.size())),
                     values.end(), [](double value) { return value == 0.0; });
}

cv::FileNode RequireKey(const cv::FileStorage& storage, const std::string& path,
                        const std::string& key) {
  const cv::FileNode node = storage[key];
  if (node.empty()) {
    Fail(path, fmt::format("key '{}' is missing; an OpenCV calibration has image_width, "
                           "image_height, camera_matrix and distortion_coefficients",
                           key));
  }
  return node;
}

int ReadImageSize(const cv::FileStorage& storage, const std::string& path, const std::string& key) {
  const cv::FileNode node = RequireKey(storage, path, key);
  const double size = node.isInt() || node.isReal() ? static_cast<double>(node) : 0.0;
  if (!(size >= 1 && size <= kMaxImageSize) || size != std::floor(size)) {
    Fail(path, fmt::format("key '{}': a whole number of pixels is expected", key));
  }
  return static_cast<int>(size);
}

// ": 9 are expected, 13 found; ..." if a matrix holds another number of values than its size says,
// as decimal commas cause; otherwise empty.
std::string NumbersText(const cv::FileNode& matrix) {
  if (!matrix.isMap()) return "";
  const cv::FileNode data = matrix["data"];
  const auto num_expected = static_cast<std::size_t>(static_cast<int>(matrix["rows"])) *
                            static_cast<std::size_t>(static_cast<int>(matrix["cols"]));
  if (!data.isSeq() || data.size() == num_expected) return "";
  return fmt::format(": {} are expected, {} found; write decimal points, not decimal commas",
                     num_expected, data.size());
}

std::vector<double> ReadMatrix(const cv::FileNode& node, const std::string& path,
                               const std::string& key) {
  cv::Mat matrix;
  std::vector<double> values;
  try {
    if (node.isSeq()) {
      node >> values;
    } else if (node.isMap()) {
      constexpr int kMaxSide = 100;  // OpenCV allocates what the file claims before it reads it
      for (const char* side : {"rows", "cols"}) {
        const int size = node[side].isInt() ? static_cast<int>(node[side]) : 0;
        if (size < 1 || size > kMaxSide) {
          Fail(path, fmt::format("key '{}': 1 to {} {} are expected", key, kMaxSide, side));
        }
      }
      const std::string type = node["dt"].isString() ? node["dt"].string() : "";
      if (type != "d" && type != "f" && type != "i") {
        Fail(path, fmt::format("key '{}': dt is '{}'; expected d, numbers of 64 bits", key, type));
      }
      node >> matrix;
      matrix = matrix.reshape(1, 1);
      matrix.convertTo(matrix, CV_64F);
      values.assign(matrix.begin<double>(), matrix.end<double>());
    } else {
      Fail(path, fmt::format("key '{}': a matrix is expected", key));
    }
  } catch (const cv::Exception&) {
    Fail(path, fmt::format("key '{}': not a readable matrix; a list of numbers is expected, or "
                           "rows, cols, dt: d and as many numbers as data{}",
                           key, NumbersText(node)));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) Fail(path, fmt::format("key '{}': a value is not finite", key));
  }
  return values;
}

// fx, fy, cx, cy in the image frame.
std::vector<double> ReadPinholeParams(const cv::FileStorage& storage, const std::string& path) {
  const std::string key = "camera_matrix";
  const std::vector<double> k = ReadMatrix(RequireKey(storage, path, key), path, key);
  if (k.size() != 9) {
    Fail(path, fmt::format("key '{}': expected 3x3 values, found {}{}", key, k.size(),
                           k.size() > 9 ? "; write decimal points, not decimal commas" : ""));
  }
  const bool affine = k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1;
  if (!affine || k[1] != 0) {
    Fail(path, fmt::format("key '{}': [fx 0 cx; 0 fy cy; 0 0 1] is expected (no skew)", key));
  }
  if (!(k[0] > 0 && k[4] > 0)) {
    Fail(path,
         fmt::format("key '{}': the focal lengths {} and {} must be positive", key, k[0], k[4]));
  }
  return {k[0], k[4], k[2] + kImageFromOpenCvPx, k[5] + kImageFromOpenCvPx};
}

bool ReadIsFisheye(const cv::FileStorage& storage, const std::string& path) {
  const cv::FileNode node = storage["distortion_model"];
  if (node.empty()) return false;
  const std::string name = node.isString() ? node.string() : "";
  if (name == "fisheye") return true;
  if (name == "plumb_bob" || name == "rational_polynomial") return false;
  Fail(path, fmt::format("key 'distortion_model': '{}' is unknown; give fisheye, plumb_bob or "
                         "rational_polynomial, or leave the key out",
                         name));
}

void AppendDistortion(std::vector<double> distortion, bool fisheye, const std::string& path,
                      Camera* camera) {
  const std::string key = "distortion_coefficients";
  std::vector<double>& params = camera->params;
  if (fisheye) {
    if (distortion.size() != 4) {
      Fail(path, fmt::format("key '{}': expected 4 values for a fisheye camera, found {}", key,
                             distortion.size()));
    }
    camera->model = CameraModel::kOpenCVFisheye;
    params.insert(params.end(), distortion.begin(), distortion.end());
    return;
  }
  const std::size_t size = distortion.size();
  const bool known_size = size == 0 || size == 4 || size == 5 || size == 8;
  if (!known_size && !((size == 12 || size == 14) && AllZero(distortion, 8))) {
    Fail(path, fmt::format("key '{}': expected 0, 4, 5 or 8 values, found {} (thin prism "
                           "and tilt have no COLMAP camera model; calibrate without them)",
                           key, size));
  }
  distortion.resize(8, 0.0);
  if (AllZero(distortion, 0)) {
    camera->model = CameraModel::kPinhole;
    return;
  }
  const bool full = !AllZero(distortion, 4);
  camera->model = full ? CameraModel::kFullOpenCV : CameraModel::kOpenCV;
  params.insert(params.end(), distortion.begin(), distortion.begin() + (full ? 8 : 4));
}

Camera ReadOpenCvCalibration(const std::string& text, const std::string& path) {
  const cv::FileStorage storage = OpenStorage(text, path, "OpenCV FileStorage file");
  Camera camera;
  camera.width_px = ReadImageSize(storage, path, "image_width");
  camera.height_px = ReadImageSize(storage, path, "image_height");
  camera.params = ReadPinholeParams(storage, path);
  const cv::FileNode distortion = RequireKey(storage, path, "distortion_coefficients");
  AppendDistortion(ReadMatrix(distortion, path, "distortion_coefficients"),
                   ReadIsFisheye(storage, path), path, &camera);
  return camera;
}

Camera ParseColmapCameraLine(const std::string& line, const std::string& place) {
  std::istringstream stream(line);
  stream.imbue(std::locale::classic());
  long long camera_id = 0;
  std::string model_name;
  Camera camera;
  if (!(stream >> camera_id >> model_name >> camera.width_px >> camera.height_px)) {
    Fail(place,
         "CAMERA_ID MODEL WIDTH HEIGHT PARAMS... is expected (a COLMAP cameras.txt), or an "
         "OpenCV calibration that begins with %YAML:1.0, <?xml or {");
  }
  const std::optional<CameraModel> model = CameraModelFromName(model_name);
  if (!model) {
    Fail(place, fmt::format("camera model '{}' is not supported; use SIMPLE_PINHOLE, PINHOLE, "
                            "SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE or FULL_OPENCV",
                            model_name));
  }
  camera.model = *model;
  if (camera.width_px < 1 || camera.height_px < 1) Fail(place, "the image size must be positive");
  double value = 0.0;
  while (stream >> value) camera.params.push_back(value);
  const std::size_t num_params = static_cast<std::size_t>(NumCameraParams(camera.model));
  if (!stream.eof() || camera.params.size() != num_params) {
    Fail(place, fmt::format("expected {} parameters for {}, found {} numbers", num_params,
                            model_name, camera.params.size()));
  }
  if (!(SmallestFocalLength(camera) > 0)) Fail(place, "the focal length must be positive");
  return camera;
}

Camera ReadColmapCamera(const std::string& text, const std::string& path) {
  std::istringstream stream(text);
  std::string line;
  std::optional<Camera> camera;
  for (int line_number = 1; std::getline(stream, line); ++line_number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const std::string place = fmt::format("{}:{}", path, line_number);
    if (camera)
      Fail(place, "a second camera; velamap expects one camera for all frames, so keep one line");
    camera = ParseColmapCameraLine(line, place);
  }
  if (!camera) Fail(path, "holds no camera");
  return *camera;
}

// Rejects values that no real camera has, because later steps would fail and blame other input. The
// image circle of a fisheye camera of 220 degrees has 0.26 of its diameter as the focal length.
void CheckRangeOfParams(const Camera& camera, const std::string& path) {
  constexpr double kMaxSides = 1e4, kMinFocalSides = 0.1, kMaxFocalSides = 50;
  const double side_px = LargerSide(camera);
  const std::size_t num_focal = NumFocalLengths(camera.model);
  for (std::size_t i = 0; i < num_focal + 2; ++i) {
    const double value_px = camera.params[i];
    if (i >= num_focal) {
      if (std::abs(value_px) <= kMaxSides * side_px) continue;
      Fail(path, fmt::format("a principal point of {:g} px is out of range for pictures of {} x {} "
                             "px; check the calibration",
                             value_px, camera.width_px, camera.height_px));
    }
    const double min_px = kMinFocalSides * side_px, max_px = kMaxFocalSides * side_px;
    if (value_px >= min_px && value_px <= max_px) continue;
    Fail(path, fmt::format("a focal length of {:g} px is out of range for pictures of {} x {} px, "
                           "{:g} to {:g} px; give it in px, not in mm, and the size of the "
                           "pictures that it was found from, or leave --camera_path out",
                           value_px, camera.width_px, camera.height_px, min_px, max_px));
  }
}

}  // namespace

Camera ReadCalibration(const std::string& path) {
  const std::string text = ReadTextFile(path, "calibration file (--camera_path)");
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool storage = text.compare(begin, 5, "%YAML") == 0 || text.compare(begin, 1, "<") == 0 ||
                       text.compare(begin, 1, "{") == 0;
  const Camera camera =
      storage ? ReadOpenCvCalibration(text.substr(begin), path) : ReadColmapCamera(text, path);
  CheckRangeOfParams(camera, path);
  if (!HasMonotonicDistortion(camera)) {
    LogWarning(
        "{}: the distortion folds over inside the picture, so that two directions share one pixel; "
        "markers near the border come out wrong: calibrate again with the board in the corners of "
        "the picture, or with fewer distortion coefficients",
        path);
  }
  return camera;
}

bool IsPureScale(const Camera& camera, int width_px, int height_px) {
  const double scale_x = static_cast<double>(width_px) / camera.width_px;
  const double scale_y = static_cast<double>(height_px) / camera.height_px;
  return std::abs(camera.height_px * scale_x - height_px) <= 0.5 ||
         std::abs(camera.width_px * scale_y - width_px) <= 0.5;
}

Camera ScaleToImageSize(const Camera& camera, int width_px, int height_px,
                        const std::string& calibration_path) {
  VELAMAP_CHECK(camera.width_px > 0 && camera.height_px > 0 && width_px > 0 && height_px > 0);
  if (camera.width_px == width_px && camera.height_px == height_px) return camera;
  const double scale_x = static_cast<double>(width_px) / camera.width_px;
  const double scale_y = static_cast<double>(height_px) / camera.height_px;
  if (!IsPureScale(camera, width_px, height_px)) {
    const bool turned = IsPureScale(camera, height_px, width_px);
    Fail(calibration_path,
         fmt::format("the calibration is for {}x{} px, but the frames have {}x{}: {}; calibrate "
                     "with frames of the same kind",
                     camera.width_px, camera.height_px, width_px, height_px,
                     turned ? "they are turned by 90 degrees" : "the aspect ratio differs"));
  }
  Camera scaled = camera;
  scaled.width_px = width_px;
  scaled.height_px = height_px;
  const std::size_t center = NumFocalLengths(camera.model);
  scaled.params[0] *= center == 1 ? 0.5 * (scale_x + scale_y) : scale_x;
  if (center == 2) scaled.params[1] *= scale_y;
  scaled.params[center] *= scale_x;
  scaled.params[center + 1] *= scale_y;
  return scaled;
}

}  // namespace velamap
