#include "reconstruct/problem/marker_state.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

Eigen::Map<const Eigen::Vector3d> CornerPosition(const MarkerBlock& marker, int slot) {
  return Eigen::Map<const Eigen::Vector3d>(marker.x_in_world.data() + 3 * slot);
}

MarkerState MakeMarkerState(const Model& model, const Layout& layout) {
  std::map<int, const LayoutPart*> part_of;
  for (const LayoutPart& part : layout.parts) {
    for (const int marker_id : MarkerIds(part)) part_of.emplace(marker_id, &part);
  }
  MarkerState state;
  for (const auto& [point3D_id, point] : model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) {
      throw DataError(fmt::format(
          "point {} of the model is not a marker corner (corner c of marker k is point 10 k + c)",
          point3D_id));
    }
    const CornerId id = CornerFromPoint3DId(point3D_id);
    if (state.markers.empty() || state.markers.back().marker_id != id.marker_id) {
      MarkerBlock marker;
      marker.marker_id = id.marker_id;
      if (const auto part = part_of.find(id.marker_id); part != part_of.end()) {
        marker.part = part->second->name;
        marker.is_rigid = part->second->rigid;
      }
      state.part_scales[marker.part] = 0.0;
      marker.length_m = MarkerLength(layout, id.marker_id);
      state.markers.push_back(std::move(marker));
    }
    MarkerBlock& marker = state.markers.back();
    std::copy(point.x_in_world.begin(), point.x_in_world.end(),
              marker.x_in_world.begin() + marker.NumCoordinates());
    marker.corners.push_back(id.corner);
  }
  for (const ModelImage& image : model.images) {
    ImageBlock block{image.image_id, image.camera_id, {}};
    Eigen::Map<Eigen::Vector4d>(block.cam_from_world.data()) =
        image.cam_from_world.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>(block.cam_from_world.data() + 4) = image.cam_from_world.translation;
    state.images.push_back(block);
    state.intrinsics[image.camera_id] = model.cameras.at(image.camera_id).params;
  }
  return state;
}

void WriteMarkerState(const MarkerState& state, Model* model) {
  for (const MarkerBlock& marker : state.markers) {
    for (std::size_t slot = 0; slot < marker.corners.size(); ++slot) {
      const Point3DId point3D_id = Point3DIdFromCorner({marker.marker_id, marker.corners[slot]});
      model->points3D.at(point3D_id).x_in_world = CornerPosition(marker, static_cast<int>(slot));
    }
  }
  for (std::size_t i = 0; i < state.images.size(); ++i) {
    VELAMAP_CHECK(model->images[i].image_id == state.images[i].image_id);
    const double* pose = state.images[i].cam_from_world.data();
    model->images[i].cam_from_world.rotation =
        Eigen::Map<const Eigen::Quaterniond>(pose).normalized();
    model->images[i].cam_from_world.translation = Eigen::Map<const Eigen::Vector3d>(pose + 4);
  }
  for (const auto& [camera_id, intrinsics] : state.intrinsics) {
    model->cameras.at(camera_id).params = intrinsics;
  }
}

}  // namespace velamap
