#include "workflows/run/versions.h"

#include "importer/base/error.h"
#include "reconstruct/colmap/colmap_runner.h"
#include "workflows/run/version.h"

namespace velamap {
namespace {

// First line of COLMAP's help, such as `COLMAP 3.8 -- Structure-from-Motion and ...`.
std::string ColmapVersion(const std::string& colmap_path) {
  try {
    const std::string output = RunColmap(colmap_path, {"help"}, kNoLog);
    std::string version = output.substr(0, output.find_first_of("-\n("));
    version.erase(version.find_last_not_of(' ') + 1);
    return version;
  } catch (const std::runtime_error&) {  // the run succeeds without it
    return "not found (" + colmap_path + ")";
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> LibraryVersions(const std::string& colmap_path) {
  return {{"opencv", kOpenCvVersion},
          {"eigen", kEigenVersion},
          {"ceres", kCeresVersion},
          {"opencascade", kOpenCascadeVersion},
          {"colmap", ColmapVersion(colmap_path)}};
}

}  // namespace velamap
