// Reads a mesh in a child process. A process of many threads may only start another program after
// fork(), so the child is this program, started again with arguments that ServeMeshReader() knows.

#pragma once

#include <cstdint>
#include <filesystem>

#include "exporters/design/mesh_reader.h"

namespace velamap {

struct MeshLimits {
  int cpu_s = 120;
  int wall_s = 600;  // for a child that waits without using the processor
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;
};

// ParseMesh() in a child. Throws InputError naming the file as ParseMesh() does, and if the child
// crashes or goes beyond a limit.
TriangleMesh ParseMeshInChild(const std::filesystem::path& path, const MeshReadOptions& options,
                              const MeshLimits& limits = {});

}  // namespace velamap
