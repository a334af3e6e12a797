#include "exporters/shape_json.h"

#include <cctype>
#include <map>
#include <ostream>
#include <utility>

#include <fmt/chrono.h>
#include <nlohmann/json.hpp>

#include "importer/base/files.h"
#include "importer/camera/calibration_writer.h"
#include "importer/camera/camera_projection.h"
#include "importer/text/json_text.h"
#include "importer/text/output_date.h"

namespace velamap {
namespace {

using Json = nlohmann::ordered_json;

// {} is the unit of the formats that name none.
const std::map<std::string, const char*> kContentOf = {
    {"shape.csv", "markers with sigmas: centres (corner 0) and corners 1 to 4, m"},
    {"shape.ply", "the points of shape.csv with colours, m"},
    {"markers.ply", "a square for each whole marker, m"},
    {"alicevision.sfm", "images, cameras, poses and corners for AliceVision and Meshroom, m, px"},
    {"metashape_markers.xml", "where the pictures show the corners, for Metashape, px"},
    {"metashape_reference.csv", "the corners' coordinates for Metashape, m"},
    {"scale.csv", "the scale from each marker alone"},
    {"metrics.csv", "figures of the shape, one per row"},
    {"metrics.json", "figures of the shape, as one object"},
    {"sections.csv", "a row for each section with sigmas, or with the reason why it is missing"},
    {"sections.json", "sections with what twist is measured against, notes, residuals by marker"},
    {"sections.dxf", "curves of the sections in space, {}"},
    {"section_profiles.csv", "points of the sections: in space, m; along and off the chord, mm"},
    {"section_profiles.dxf", "the sections drawn along their chords, {}"},
    {"section_profiles.svg", "the sections drawn along their chords, with their figures"},
    {"surface.step", "smooth surface as a spline, with sections and markers, mm"},
    {"surface.igs", "smooth surface as a spline, with sections and markers, mm"},
    {"surface.ply", "triangles of the smooth surface, m"},
    {"surface.obj", "triangles of the smooth surface, {}"},
    {"surface.stl", "triangles of the smooth surface, {}"},
    {"surface.vts", "structured grid of the smooth surface for ParaView, m"},
    {"surface.msh", "structured grid of the smooth surface for Gmsh, {}"},
    {"surface_ansys.txt", "structured grid of the smooth surface for ANSYS, {}"},
    {"surface_residuals.csv", "distances of the markers from the smooth surface, m"},
    {"surface_edges.csv", "points of the edges of the smooth surface with sigmas, m"},
    {"freeform.ply", "triangles through the markers of a part without lines, with sigmas, m"},
    {"freeform.obj", "triangles through the markers of a part without lines, {}"},
    {"freeform.stl", "triangles through the markers of a part without lines, {}"},
    {"freeform_residuals.csv", "distances of the corners from the freeform surfaces, m"},
};

// surface.step of surface_2.step: further parts have a number in the names of their files.
std::string WithoutNumber(std::string name) {
  for (std::size_t i = name.find('_'); i != std::string::npos; i = name.find('_', i + 1)) {
    std::size_t end = i + 1;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end]))) ++end;
    if (end > i + 1) return name.erase(i, end - i);
  }
  return name;
}

Json ParamsOf(const Camera& camera) {
  std::vector<std::string> names = {"fx", "fy", "cx", "cy"};
  if (HasOneFocalLength(camera.model)) names = {"f", "cx", "cy"};
  const std::size_t num_before_distortion = names.size();
  Json params = Json::object();
  for (std::size_t i = 0; i < camera.params.size(); ++i) {
    if (i >= names.size()) {
      names.push_back(DistortionName(camera.model, i - num_before_distortion));
    }
    params[names[i]] = camera.params[i];
  }
  return params;
}

Json CamerasOf(const Model& model, const std::optional<bool>& is_found) {
  std::map<CameraId, int> num_images;
  for (const ModelImage& image : model.images) ++num_images[image.camera_id];
  Json cameras = Json::array();
  for (const auto& [camera_id, count] : num_images) {
    const Camera& camera = model.cameras.at(camera_id);
    Json object = {{"camera_id", camera_id},      {"model", CameraModelName(camera.model)},
                   {"width_px", camera.width_px}, {"height_px", camera.height_px},
                   {"params", ParamsOf(camera)},  {"num_images", count}};
    if (is_found) object["found_without_calibration"] = *is_found;
    cameras.push_back(std::move(object));
  }
  return cameras;
}

}  // namespace

DescribedFiles DescribeShapeFiles(const std::filesystem::path& folder, LengthUnit unit,
                                  const std::map<std::string, std::string>& part_of_stem) {
  DescribedFiles files;
  for (const std::filesystem::path& path : FolderEntries(folder)) {
    const std::string name = path.filename().string();
    const auto content = kContentOf.find(WithoutNumber(name));
    if (content == kContentOf.end()) continue;
    std::string text = fmt::format(fmt::runtime(content->second), ChoiceName(kLengthUnits, unit));
    const auto part = part_of_stem.find(path.stem().string());
    if (part != part_of_stem.end() && !part->second.empty()) text += "; part " + part->second;
    files.emplace_back(name, std::move(text));
  }
  return files;
}

void WriteShapeJson(const ShapeFrame& frame, const Model& model, int num_markers,
                    const ShapeOrigin& origin, const Verdict* verdict, const DescribedFiles& files,
                    std::ostream& out) {
  Json root;
  if (!origin.clip.empty()) root["clip"] = origin.clip;
  root["date"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", OutputDate());
  if (!origin.version.empty()) root["velamap_version"] = origin.version;
  if (verdict != nullptr) root["verdict"] = VerdictJson(*verdict);
  root["frame"] = {
      {"name", frame.name}, {"description", frame.description}, {"reasons", frame.reasons}};
  root["units"] = {{"length", "m"},
                   {"sigma", "m, 1 standard deviation; empty if unknown"},
                   {"camera", "px of COLMAP's image frame; distortion without unit"}};
  root["num_markers"] = num_markers;
  root["num_images"] = model.images.size();
  root["cameras"] = CamerasOf(model, origin.is_camera_found);
  root["files"] = Json::object();
  for (const auto& [name, content] : files) root["files"][name] = content;
  out << JsonText(root, 1) << '\n';
}

}  // namespace velamap
