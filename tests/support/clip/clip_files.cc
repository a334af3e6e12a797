#include "tests/support/clip/clip_files.h"

#include <functional>
#include <ostream>
#include <vector>

#include "exporters/formats/shape_csv.h"
#include "importer/base/atomic_output.h"
#include "importer/camera/calibration_writer.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout_writer.h"

namespace velamap {
namespace {

void WritePoses(const ClipScene& scene, std::ostream& out) {
  out << "frame,qw,qx,qy,qz,tx,ty,tz\n";
  for (int i = 0; i < scene.options.num_frames; ++i) {
    const auto [q, t] = scene.cam_from_world(i);
    out << i << ',' << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << t.x() << ','
        << t.y() << ',' << t.z() << '\n';
  }
}

}  // namespace

void WriteClipFiles(const ClipScene& scene, const std::filesystem::path& folder) {
  const auto write = [&](const char* name, const std::function<void(std::ostream&)>& content) {
    WriteFileAtomically(folder / name, content);
  };
  const std::vector<double> exact(scene.camera.params.size(), 0.0);
  write("camera.yml", [&](std::ostream& out) {
    out << CalibrationText({scene.camera, exact}, "of a rendered clip");
  });
  write("layout.yml", [&](std::ostream& out) { out << LayoutText(scene.layout, ""); });
  if (scene.options.dictionary_bits == 3) {
    write(scene.layout.dictionary.c_str(),
          [&](std::ostream& out) { out << DictionaryText(scene.dictionary); });
  }
  write("truth.csv", [&](std::ostream& out) { WriteShapeCsv(TrueShape(scene, false), out); });
  if (scene.options.trim_change_m > 0) {
    write("truth_after.csv",
          [&](std::ostream& out) { WriteShapeCsv(TrueShape(scene, true), out); });
  }
  write("poses.csv", [&](std::ostream& out) { WritePoses(scene, out); });
}

}  // namespace velamap
