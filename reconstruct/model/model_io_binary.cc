// The binary format of model_io.h: little-endian without padding, as COLMAP has written it
// since 3.0 (format.html of its documentation).

#include <array>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>
#include <type_traits>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/model_records.h"

namespace velamap {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the files are little-endian");

class BinaryReader {
 public:
  BinaryReader(std::istream& in, const std::string& name) : in_(in), name_(name) {}

  // `what` is the name of the record for the error message.
  template <typename T>
  T Read(const std::string& what) {
    static_assert(std::is_arithmetic_v<T>);
    std::array<char, sizeof(T)> bytes;
    in_.read(bytes.data(), bytes.size());
    if (!in_) Fail(fmt::format("ends in the middle of {}; the file is truncated", what));
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  Eigen::Vector2d ReadVector2(const std::string& what) {
    const double x = Read<double>(what);
    return {x, Read<double>(what)};
  }

  Eigen::Vector3d ReadVector3(const std::string& what) {
    const double x = Read<double>(what);
    const double y = Read<double>(what);
    return {x, y, Read<double>(what)};
  }

  std::string ReadString(const std::string& what) {
    std::string text;
    if (!std::getline(in_, text, '\0') || in_.eof()) {
      Fail(fmt::format("ends in the middle of {}; the file is truncated", what));
    }
    return text;
  }

  void ExpectEnd() {
    if (in_.peek() != std::istream::traits_type::eof()) {
      Fail("continues after the last entry; it is damaged or not a COLMAP file of this name");
    }
  }

  [[noreturn]] void Fail(const std::string& why) const {
    throw InputError(fmt::format("{}: {}", name_, why));
  }

 private:
  std::istream& in_;
  const std::string& name_;
};

template <typename T>
void Write(std::ostream& out, T value) {
  static_assert(std::is_arithmetic_v<T>);
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  out.write(bytes.data(), bytes.size());
}

}  // namespace

void ReadCamerasBinary(std::istream& in, const std::string& name, Model* model) {
  BinaryReader reader(in, name);
  const auto num_cameras = reader.Read<std::uint64_t>("the number of cameras");
  for (std::uint64_t i = 0; i < num_cameras; ++i) {
    const std::string what = fmt::format("camera {} of {}", i + 1, num_cameras);
    const auto camera_id = reader.Read<CameraId>(what);
    const auto model_id = reader.Read<std::int32_t>(what);
    const auto camera_model = CameraModelFromId(model_id);
    if (!camera_model) reader.Fail(UnknownCameraModel(camera_id, std::to_string(model_id)));
    Camera camera;
    camera.model = *camera_model;
    for (int* size_px : {&camera.width_px, &camera.height_px}) {
      const auto value = reader.Read<std::uint64_t>(what);
      if (value > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
        reader.Fail(fmt::format("camera {} has an impossible size of {} px", camera_id, value));
      }
      *size_px = static_cast<int>(value);
    }
    for (int j = 0; j < NumCameraParams(camera.model); ++j) {
      camera.params.push_back(reader.Read<double>(what));
    }
    if (!model->cameras.emplace(camera_id, camera).second) {
      reader.Fail(fmt::format("there are two cameras with the id {}", camera_id));
    }
  }
  reader.ExpectEnd();
}

void ReadImagesBinary(std::istream& in, const std::string& name, Model* model) {
  BinaryReader reader(in, name);
  const auto num_images = reader.Read<std::uint64_t>("the number of images");
  for (std::uint64_t i = 0; i < num_images; ++i) {
    const std::string what = fmt::format("image {} of {}", i + 1, num_images);
    ModelImage image;
    image.image_id = reader.Read<ImageId>(what);
    const double w = reader.Read<double>(what);
    const Eigen::Vector3d xyz = reader.ReadVector3(what);
    const auto rotation = RotationFromFile({w, xyz.x(), xyz.y(), xyz.z()});
    if (!rotation) reader.Fail(NoRotation(image.image_id));
    image.cam_from_world = {*rotation, reader.ReadVector3(what)};
    image.camera_id = reader.Read<CameraId>(what);
    image.name = reader.ReadString(what);
    const auto num_points2D = reader.Read<std::uint64_t>(what);
    for (std::uint64_t j = 0; j < num_points2D; ++j) {
      const Eigen::Vector2d x_in_image_px = reader.ReadVector2(what);
      image.points2D.push_back({x_in_image_px, reader.Read<Point3DId>(what)});
    }
    model->images.push_back(std::move(image));
  }
  reader.ExpectEnd();
}

void ReadPoints3DBinary(std::istream& in, const std::string& name, Model* model) {
  BinaryReader reader(in, name);
  const auto num_points = reader.Read<std::uint64_t>("the number of points");
  for (std::uint64_t i = 0; i < num_points; ++i) {
    const std::string what = fmt::format("point {} of {}", i + 1, num_points);
    const auto point3D_id = reader.Read<Point3DId>(what);
    Point3D point;
    point.x_in_world = reader.ReadVector3(what);
    for (std::uint8_t& channel : point.color) channel = reader.Read<std::uint8_t>(what);
    point.mean_error_px = reader.Read<double>(what);
    const auto track_length = reader.Read<std::uint64_t>(what);
    for (std::uint64_t j = 0; j < track_length; ++j) {
      const auto image_id = reader.Read<ImageId>(what);
      point.track.push_back({image_id, reader.Read<std::uint32_t>(what)});
    }
    if (!model->points3D.emplace(point3D_id, std::move(point)).second) {
      reader.Fail(fmt::format("there are two points with the id {}", point3D_id));
    }
  }
  reader.ExpectEnd();
}

void WriteCamerasBinary(const Model& model, std::ostream& out) {
  Write<std::uint64_t>(out, model.cameras.size());
  for (const auto& [camera_id, camera] : model.cameras) {
    Write<std::uint32_t>(out, camera_id);
    Write<std::int32_t>(out, static_cast<std::int32_t>(camera.model));
    Write<std::uint64_t>(out, static_cast<std::uint64_t>(camera.width_px));
    Write<std::uint64_t>(out, static_cast<std::uint64_t>(camera.height_px));
    for (const double param : camera.params) Write<double>(out, param);
  }
}

void WriteImagesBinary(const Model& model, std::ostream& out) {
  Write<std::uint64_t>(out, model.images.size());
  for (const ModelImage& image : model.images) {
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    Write<std::uint32_t>(out, image.image_id);
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) Write<double>(out, value);
    for (const double value : image.cam_from_world.translation) Write<double>(out, value);
    Write<std::uint32_t>(out, image.camera_id);
    out.write(image.name.c_str(), static_cast<std::streamsize>(image.name.size() + 1));
    Write<std::uint64_t>(out, image.points2D.size());
    for (const Point2D& point2D : image.points2D) {
      for (const double value : point2D.x_in_image_px) Write<double>(out, value);
      Write<std::uint64_t>(out, point2D.point3D_id);
    }
  }
}

void WritePoints3DBinary(const Model& model, std::ostream& out) {
  Write<std::uint64_t>(out, model.points3D.size());
  for (const auto& [point3D_id, point] : model.points3D) {
    Write<std::uint64_t>(out, point3D_id);
    for (const double value : point.x_in_world) Write<double>(out, value);
    for (const std::uint8_t channel : point.color) Write<std::uint8_t>(out, channel);
    Write<double>(out, point.mean_error_px);
    Write<std::uint64_t>(out, point.track.size());
    for (const TrackElement& element : SortedTrack(point)) {
      Write<std::uint32_t>(out, element.image_id);
      Write<std::uint32_t>(out, element.point2D_idx);
    }
  }
}

}  // namespace velamap
