// Reads mesh and CAD files in this process, with libraries that crash, hang or take all memory on
// bad ones. ReadMesh() (mesh_reader.h) calls it in a child process.

#pragma once

#include <cstdint>
#include <filesystem>

#include "exporters/design/mesh_reader.h"

namespace velamap {

// Larger files are refused. The largest that velamap writes are OBJ of 5 million triangles.
inline constexpr std::uintmax_t kMaxMeshFileSize = std::uintmax_t{512} << 20;

// The most vertices or triangles that can be compared.
inline constexpr std::size_t kMaxMeshElements = 20'000'000;

// Throws InputError naming the file if it cannot be opened as one of these formats: another
// extension, missing, no regular file, or too large.
void CheckMeshFile(const std::filesystem::path& path);

// As ReadMesh(), of a file that CheckMeshFile() accepts.
TriangleMesh ParseMesh(const std::filesystem::path& path, const MeshReadOptions& options);

}  // namespace velamap
