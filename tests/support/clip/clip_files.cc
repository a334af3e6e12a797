#include "tests/support/clip/clip_files.h"

#include <ostream>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/atomic_output.h"
#include "importer/camera/calibration_writer.h"
#include "importer/text/write_formatted.h"

namespace velamap {
namespace {

// An OpenCV principal point counts from the first pixel's centre.
void WriteCamera(const Camera& camera, std::ostream& out) {
  if (camera.model != CameraModel::kOpenCV) {
    const std::vector<double> exact(camera.params.size(), 0.0);
    out << CalibrationText({camera, exact}, "of a rendered clip");
    return;
  }
  const std::vector<double>& p = camera.params;
  WriteFormatted(out,
                 "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
                 "camera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
                 "  data: [{:.17g}, 0., {:.17g}, 0., {:.17g}, {:.17g}, 0., 0., 1.]\n"
                 "distortion_coefficients: !!opencv-matrix\n  rows: 1\n  cols: 4\n  dt: d\n"
                 "  data: [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n",
                 camera.width_px, camera.height_px, p[0], p[2] - 0.5, p[1], p[3] - 0.5, p[4], p[5],
                 p[6], p[7]);
}

void WriteDictionary(const Dictionary& dictionary, std::ostream& out) {
  const cv::aruco::Dictionary& aruco = *dictionary.aruco;
  WriteFormatted(out, "%YAML:1.0\n---\nnmarkers: {}\nmarkersize: {}\nmaxCorrectionBits: {}\n",
                 aruco.bytesList.rows, aruco.markerSize, aruco.maxCorrectionBits);
  for (int id = 0; id < aruco.bytesList.rows; ++id) {
    const cv::Mat bits =
        cv::aruco::Dictionary::getBitsFromByteList(aruco.bytesList.row(id), aruco.markerSize);
    std::string text;
    for (const auto bit : cv::Mat_<std::uint8_t>(bits)) text += bit ? '1' : '0';
    WriteFormatted(out, "marker_{}: \"{}\"\n", id, text);
  }
}

void WriteLines(const char* key, const std::vector<MarkerLine>& lines, std::ostream& out) {
  if (lines.empty()) return;
  WriteFormatted(out, "    {}:\n", key);
  for (const MarkerLine& line : lines) {
    WriteFormatted(out, "      - {{name: {}, markers: [{}]}}\n", line.name,
                   fmt::join(line.marker_ids, ", "));
  }
}

void WritePoses(const ClipScene& scene, std::ostream& out) {
  out << "frame,qw,qx,qy,qz,tx,ty,tz\n";
  for (int i = 0; i < scene.options.num_frames; ++i) {
    const auto [q, t] = scene.cam_from_world(i);
    out << i << ',' << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << t.x() << ','
        << t.y() << ',' << t.z() << '\n';
  }
}

}  // namespace

void WriteLayout(const Layout& layout, std::ostream& out) {
  WriteFormatted(out, "dictionary: {}\nmarker_length: {}\nborder_bits: {}\nparts:\n",
                 layout.dictionary, layout.marker_length_m, layout.border_bits);
  for (const LayoutPart& part : layout.parts) {
    WriteFormatted(out, "  {}:\n", part.name);
    WriteLines("horizontal", part.horizontal, out);
    WriteLines("vertical", part.vertical, out);
    if (!part.marker_ids.empty()) {
      WriteFormatted(out, "    markers: [{}]\n", fmt::join(part.marker_ids, ", "));
    }
    if (part.rigid) out << "    rigid: true\n";
  }
  if (layout.reference_part) WriteFormatted(out, "reference_part: {}\n", *layout.reference_part);
}

void WriteClipFiles(const ClipScene& scene, const std::filesystem::path& folder) {
  const auto write = [&](const char* name, const std::function<void(std::ostream&)>& content) {
    WriteFileAtomically(folder / name, content);
  };
  write("camera.yml", [&](std::ostream& out) { WriteCamera(scene.camera, out); });
  write("layout.yml", [&](std::ostream& out) { WriteLayout(scene.layout, out); });
  if (scene.options.dictionary_bits == 3) {
    write(scene.layout.dictionary.c_str(),
          [&](std::ostream& out) { WriteDictionary(scene.dictionary, out); });
  }
  write("truth.csv", [&](std::ostream& out) { WriteShapeCsv(TrueShape(scene, false), out); });
  if (scene.options.trim_change_m > 0) {
    write("truth_after.csv",
          [&](std::ostream& out) { WriteShapeCsv(TrueShape(scene, true), out); });
  }
  write("poses.csv", [&](std::ostream& out) { WritePoses(scene, out); });
}

}  // namespace velamap
