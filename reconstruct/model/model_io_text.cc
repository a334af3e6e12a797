// The text format of model_io.h. Numbers do not depend on the locale.

#include <cctype>
#include <istream>
#include <ostream>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/model_records.h"

namespace velamap {
namespace {

// Reads line by line, and each line field by field.
class LineReader {
 public:
  LineReader(std::istream& in, const std::string& name) : in_(in), name_(name) {}

  // Goes to the next line, even an empty one. Returns false at the end of the file.
  bool NextLine() {
    if (!std::getline(in_, line_)) {
      if (in_.bad()) throw InputError(fmt::format("{}: cannot be read", name_));
      return false;
    }
    ++line_number_;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    rest_ = line_;
    SkipSpace();
    return true;
  }

  // Goes to the next line that is neither empty nor a comment.
  bool NextRecord() {
    while (NextLine()) {
      if (!AtEnd() && rest_.front() != '#') return true;
    }
    return false;
  }

  bool AtEnd() const { return rest_.empty(); }

  // `what` is the field's name for the error message.
  template <typename T>
  T Number(const char* what) {
    static_assert(std::is_arithmetic_v<T>);
    const std::string_view word = Word(what);
    T value{};
    if (!ParseNumber(word, &value)) {
      Fail(fmt::format("expected {} as a {}, found '{}'", what, Kind<T>(), word));
    }
    return value;
  }

  std::string_view Word(const char* what) {
    if (AtEnd()) Fail(fmt::format("expected {}, but the line ends", what));
    std::size_t length = 0;
    while (length < rest_.size() && !IsSpace(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    SkipSpace();
    return word;
  }

  // The rest of the line; names of images may contain spaces.
  std::string Rest(const char* what) {
    if (AtEnd()) Fail(fmt::format("expected {}, but the line ends", what));
    const std::string rest(rest_);
    rest_ = {};
    return rest;
  }

  void ExpectEnd() const {
    if (!AtEnd()) Fail(fmt::format("expected the end of the line, found '{}'", rest_));
  }

  [[noreturn]] void Fail(const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", name_, line_number_, why));
  }

 private:
  static bool IsSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

  template <typename T>
  static const char* Kind() {
    if (std::is_floating_point_v<T>) return "number";
    return std::is_signed_v<T> ? "whole number" : "whole number from 0";
  }

  void SkipSpace() {
    while (!rest_.empty() && IsSpace(rest_.front())) rest_.remove_prefix(1);
  }

  std::istream& in_;
  const std::string& name_;
  int line_number_ = 0;
  std::string line_;
  std::string_view rest_;
};

// Braces guarantee that the fields are read in order; function arguments would not.
Eigen::Vector3d ReadVector3(LineReader* reader, const char* x, const char* y, const char* z) {
  return Eigen::Vector3d{reader->Number<double>(x), reader->Number<double>(y),
                         reader->Number<double>(z)};
}

void ReadPoints2D(LineReader* reader, ModelImage* image) {
  while (!reader->AtEnd()) {
    const double x = reader->Number<double>("X");
    const double y = reader->Number<double>("Y");
    const auto point3D_id = reader->Number<std::int64_t>("POINT3D_ID");
    if (point3D_id < -1) {
      reader->Fail(fmt::format("expected POINT3D_ID from 0, or -1 for none, found {}", point3D_id));
    }
    image->points2D.push_back(
        {{x, y}, point3D_id < 0 ? kInvalidPoint3DId : static_cast<Point3DId>(point3D_id)});
  }
}

}  // namespace

void ReadCamerasText(std::istream& in, const std::string& name, Model* model) {
  LineReader reader(in, name);
  while (reader.NextRecord()) {
    const auto camera_id = reader.Number<CameraId>("CAMERA_ID");
    const std::string model_name(reader.Word("MODEL"));
    const auto camera_model = CameraModelFromName(model_name);
    if (!camera_model) reader.Fail(UnknownCameraModel(camera_id, model_name));
    Camera camera;
    camera.model = *camera_model;
    camera.width_px = reader.Number<int>("WIDTH");
    camera.height_px = reader.Number<int>("HEIGHT");
    for (int i = 0; i < NumCameraParams(camera.model); ++i) {
      camera.params.push_back(reader.Number<double>("PARAMS[]"));
    }
    reader.ExpectEnd();
    if (!model->cameras.emplace(camera_id, camera).second) {
      reader.Fail(fmt::format("there are two cameras with the id {}", camera_id));
    }
  }
}

void ReadImagesText(std::istream& in, const std::string& name, Model* model) {
  LineReader reader(in, name);
  while (reader.NextRecord()) {
    ModelImage image;
    image.image_id = reader.Number<ImageId>("IMAGE_ID");
    const double w = reader.Number<double>("QW");
    const Eigen::Vector3d xyz = ReadVector3(&reader, "QX", "QY", "QZ");
    const auto rotation = RotationFromFile({w, xyz.x(), xyz.y(), xyz.z()});
    if (!rotation) reader.Fail(NoRotation(image.image_id));
    image.cam_from_world = {*rotation, ReadVector3(&reader, "TX", "TY", "TZ")};
    image.camera_id = reader.Number<CameraId>("CAMERA_ID");
    image.name = reader.Rest("NAME");
    // An image without 2D points has an empty second line.
    if (!reader.NextLine()) reader.Fail("the line of 2D points is missing; the file is truncated");
    ReadPoints2D(&reader, &image);
    model->images.push_back(std::move(image));
  }
}

void ReadPoints3DText(std::istream& in, const std::string& name, Model* model) {
  LineReader reader(in, name);
  while (reader.NextRecord()) {
    const auto point3D_id = reader.Number<Point3DId>("POINT3D_ID");
    Point3D point;
    point.x_in_world = ReadVector3(&reader, "X", "Y", "Z");
    for (std::uint8_t& channel : point.color) channel = reader.Number<std::uint8_t>("R G B");
    point.mean_error_px = reader.Number<double>("ERROR");
    while (!reader.AtEnd()) {
      const auto image_id = reader.Number<ImageId>("IMAGE_ID");
      point.track.push_back({image_id, reader.Number<std::uint32_t>("POINT2D_IDX")});
    }
    if (!model->points3D.emplace(point3D_id, std::move(point)).second) {
      reader.Fail(fmt::format("there are two points with the id {}", point3D_id));
    }
  }
}

void WriteCamerasText(const Model& model, std::ostream& out) {
  out << fmt::format("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n");
  for (const auto& [camera_id, camera] : model.cameras) {
    out << fmt::format("{} {} {} {}", camera_id, CameraModelName(camera.model), camera.width_px,
                       camera.height_px);
    for (const double param : camera.params) out << fmt::format(" {:.17g}", param);
    out << '\n';
  }
}

void WriteImagesText(const Model& model, std::ostream& out) {
  out << fmt::format(
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n"
      "# POINTS2D[] as X Y POINT3D_ID\n");
  for (const ModelImage& image : model.images) {
    if (image.name.find_first_of("\r\n") != std::string::npos) {
      throw InputError(
          fmt::format("image {}: images.txt cannot hold a name with a line break; rename the image",
                      image.image_id));
    }
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    const Eigen::Vector3d& t = image.cam_from_world.translation;
    out << fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {} {}\n",
                       image.image_id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(),
                       image.camera_id, image.name);
    const char* separator = "";
    for (const Point2D& point2D : image.points2D) {
      // As a signed number, kInvalidPoint3DId is -1.
      out << fmt::format("{}{:.17g} {:.17g} {}", separator, point2D.x_in_image_px.x(),
                         point2D.x_in_image_px.y(), static_cast<std::int64_t>(point2D.point3D_id));
      separator = " ";
    }
    out << '\n';
  }
}

void WritePoints3DText(const Model& model, std::ostream& out) {
  out << fmt::format("# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n");
  for (const auto& [point3D_id, point] : model.points3D) {
    const Eigen::Vector3d& x = point.x_in_world;
    out << fmt::format("{} {:.17g} {:.17g} {:.17g} {} {} {} {:.17g}", point3D_id, x.x(), x.y(),
                       x.z(), point.color[0], point.color[1], point.color[2], point.mean_error_px);
    for (const TrackElement& element : SortedTrack(point)) {
      out << fmt::format(" {} {}", element.image_id, element.point2D_idx);
    }
    out << '\n';
  }
}

}  // namespace velamap
