#include "exporters/sail/sail_shape.h"

#include <functional>
#include <iosfwd>
#include <utility>

#include <fmt/format.h>

#include "exporters/formats/cad_writer.h"
#include "exporters/formats/mesh_writer.h"
#include "exporters/sail/section_drawing.h"
#include "exporters/sail/section_writer.h"
#include "exporters/surface/surface_csv.h"
#include "exporters/surface/surface_input.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

// A boat has a few sails. Further parts with lines get no surface.
constexpr int kMaxSurfaces = 20;

SailSurface MakeSailSurface(const MarkerShape& shape, const Layout& layout, const LayoutPart& part,
                            const SailOptions& options) {
  SailSurface surface;
  surface.part = part.name;
  surface.fit = FitSurface(CollectSurfaceInput(shape, part), options.surface);
  surface.area_m2 = SurfaceArea(surface.fit.surface);
  surface.mesh = MeshSurface(
      surface.fit.surface,
      options.mesh.value_or(DefaultMeshOptions(surface.fit.surface, layout.marker_length_m)));
  return surface;
}

std::string Suffix(int surface_idx) {
  return surface_idx == 0 ? "" : fmt::format("_{}", surface_idx + 1);
}

struct SurfaceFile {
  std::string name;
  std::function<void(const SailSurface&, const std::string& title, std::ostream&)> write;
};

std::vector<SurfaceFile> SurfaceFiles(int surface_idx) {
  const std::string stem = "surface" + Suffix(surface_idx);
  const auto cad = [](auto writer) {
    return [writer](const SailSurface& surface, const std::string& title, std::ostream& out) {
      writer(surface.fit.surface, title, out);
    };
  };
  const auto mesh = [](auto writer) {
    return [writer](const SailSurface& surface, const std::string& title, std::ostream& out) {
      writer(surface.mesh, title, out);
    };
  };
  return {{stem + ".step", cad(WriteStep)},
          {stem + ".igs", cad(WriteIges)},
          {stem + ".ply", mesh(WriteMeshPly)},
          {stem + ".obj", mesh(WriteMeshObj)},
          {stem + ".stl", mesh(WriteMeshStl)},
          {fmt::format("surface_residuals{}.csv", Suffix(surface_idx)),
           [](const SailSurface& surface, const std::string&, std::ostream& out) {
             WriteSurfaceResidualsCsv(surface.fit, out);
           }},
          {fmt::format("surface_edges{}.csv", Suffix(surface_idx)),
           [](const SailSurface& surface, const std::string&, std::ostream& out) {
             WriteSurfaceEdgesCsv(surface.fit, out);
           }}};
}

using SectionWriter = void (*)(const SectionReport&, const ShapeFrame&, std::ostream&);
const std::vector<std::pair<std::string, SectionWriter>>& SectionFiles() {
  static const std::vector<std::pair<std::string, SectionWriter>> files = {
      {"sections.csv", WriteSectionsCsv},
      {"sections.json", WriteSectionsJson},
      {"sections.dxf", WriteSectionsDxf},
      {"section_profiles.csv", WriteSectionProfilesCsv},
      {"section_profiles.dxf", WriteSectionProfilesDxf},
      {"section_profiles.svg", WriteSectionProfilesSvg}};
  return files;
}

}  // namespace

void SailShape::ThrowSurfaceError() const {
  if (surface_error) std::rethrow_exception(surface_error);
}

void SailOptions::Check() const {
  sections.Check();
  surface.Check();
  if (mesh) mesh->Check();
}

SailShape ComputeSail(const MarkerShape& shape, const ShapeFrame& frame, const Layout& layout,
                      const PointCovariance* covariance, const SailOptions& options) {
  options.Check();
  SailShape sail;
  sail.sections = ComputeSections(shape, frame, layout, covariance, options.sections);
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    if (static_cast<int>(sail.surfaces.size()) == kMaxSurfaces) {
      sail.surface_notes.push_back(
          fmt::format("{}: no surface: at most {} parts get one", part.name, kMaxSurfaces));
      continue;
    }
    try {
      sail.surfaces.push_back(MakeSailSurface(shape, layout, part, options));
      for (const std::string& note : sail.surfaces.back().fit.notes) {
        sail.surface_notes.push_back(fmt::format("{}: {}", part.name, note));
      }
    } catch (const std::exception& error) {
      sail.surface_notes.push_back(fmt::format("{}: no surface: {}", part.name, error.what()));
      const bool is_of_data = dynamic_cast<const DataError*>(&error) != nullptr;
      if (!is_of_data && !sail.surface_error) sail.surface_error = std::current_exception();
    }
  }
  return sail;
}

void WriteSailFiles(const SailShape& sail, const ShapeFrame& frame,
                    const std::filesystem::path& folder) {
  if (!sail.sections.sections.empty() || !sail.sections.missing.empty()) {
    for (const auto& [name, writer] : SectionFiles()) {
      WriteFile(folder / name,
                [&, write = writer](std::ostream& out) { write(sail.sections, frame, out); });
    }
  }
  for (std::size_t i = 0; i < sail.surfaces.size(); ++i) {
    const SailSurface& surface = sail.surfaces[i];
    const std::string title = fmt::format("{} (frame: {})", surface.part, frame.name);
    for (const SurfaceFile& file : SurfaceFiles(static_cast<int>(i))) {
      WriteFile(folder / file.name, [&](std::ostream& out) { file.write(surface, title, out); });
    }
  }
}

}  // namespace velamap
