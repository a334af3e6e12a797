#include "exporters/exchange/metashape_markers.h"

#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

std::string CornerLabel(const CornerId& corner) {
  return fmt::format("{}_{}", corner.marker_id, corner.corner);
}

void AppendCameras(const Model& model, pugi::xml_node chunk) {
  pugi::xml_node cameras = chunk.append_child("cameras");
  std::map<std::string, std::string> name_of_label;
  for (const ModelImage& image : model.images) {
    const std::string label = std::filesystem::path(image.name).stem().string();
    const auto [other, is_new] = name_of_label.emplace(label, image.name);
    if (!is_new) {
      throw InputError(fmt::format(
          "images {} and {}: both are {} in Metashape; give their files different names",
          other->second, image.name, label));
    }
    pugi::xml_node camera = cameras.append_child("camera");
    camera.append_attribute("id") = image.image_id;
    camera.append_attribute("label") = label.c_str();
  }
}

void AppendMarkers(const Model& model, pugi::xml_node chunk) {
  pugi::xml_node markers = chunk.append_child("markers");
  for (const auto& [point3D_id, point] : model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) continue;
    pugi::xml_node marker = markers.append_child("marker");
    marker.append_attribute("id") = point3D_id;
    marker.append_attribute("label") = CornerLabel(CornerFromPoint3DId(point3D_id)).c_str();
  }
}

void AppendProjections(const Model& model, pugi::xml_node chunk) {
  pugi::xml_node frame = chunk.append_child("frames").append_child("frame");
  frame.append_attribute("id") = 0;
  pugi::xml_node markers = frame.append_child("markers");
  for (const auto& [point3D_id, point] : model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) continue;
    pugi::xml_node marker = markers.append_child("marker");
    marker.append_attribute("marker_id") = point3D_id;
    for (const TrackElement& element : point.track) {
      const Eigen::Vector2d& corner_in_image_px =
          model.FindImage(element.image_id)->points2D.at(element.point2D_idx).x_in_image_px;
      pugi::xml_node location = marker.append_child("location");
      location.append_attribute("camera_id") = element.image_id;
      location.append_attribute("pinned") = true;
      location.append_attribute("x") = fmt::format("{}", corner_in_image_px.x()).c_str();
      location.append_attribute("y") = fmt::format("{}", corner_in_image_px.y()).c_str();
    }
  }
}

}  // namespace

void WriteMetashapeMarkers(const Model& model, std::ostream& out) {
  pugi::xml_document file;
  pugi::xml_node declaration = file.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node document = file.append_child("document");
  document.append_attribute("version") = "1.5.0";
  pugi::xml_node chunk = document.append_child("chunk");
  chunk.append_attribute("label") = "velamap";
  chunk.append_attribute("enabled") = true;
  AppendCameras(model, chunk);
  AppendMarkers(model, chunk);
  AppendProjections(model, chunk);
  file.save(out, "  ");
}

void WriteMetashapeReference(const MarkerShape& shape, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("label", "x", "y", "z", "accuracy");
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const std::optional<Eigen::Vector3d>& x_in_shape_m = marker.x_in_shape_m[corner];
      if (!x_in_shape_m) continue;
      const std::optional<Eigen::Vector3d>& sigma_m = marker.sigma_m[corner];
      csv.WriteRecord(CornerLabel({marker.marker_id, corner}), x_in_shape_m->x(), x_in_shape_m->y(),
                      x_in_shape_m->z(),
                      sigma_m ? std::optional(SigmaOfCoordinate(*sigma_m)) : std::nullopt);
    }
  }
}

}  // namespace velamap
