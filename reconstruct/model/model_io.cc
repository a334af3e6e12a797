#include "reconstruct/model/model_io.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/text/text_file.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Models of the markers in tens of thousands of images are far smaller.
constexpr std::uintmax_t kMaxModelFileSize = std::uintmax_t{4} << 30;

using Reader = void (*)(std::istream& in, const std::string& name, Model* model);
using Writer = void (*)(const Model& model, std::ostream& out);

struct ModelFile {
  const char* name;
  Reader read;
  Writer write;
};
constexpr std::array<ModelFile, 3> kBinaryFiles = {
    {{"cameras.bin", ReadCamerasBinary, WriteCamerasBinary},
     {"images.bin", ReadImagesBinary, WriteImagesBinary},
     {"points3D.bin", ReadPoints3DBinary, WritePoints3DBinary}}};
constexpr std::array<ModelFile, 3> kTextFiles = {
    {{"cameras.txt", ReadCamerasText, WriteCamerasText},
     {"images.txt", ReadImagesText, WriteImagesText},
     {"points3D.txt", ReadPoints3DText, WritePoints3DText}}};

bool HasAny(const fs::path& path, const std::array<ModelFile, 3>& files) {
  return std::any_of(files.begin(), files.end(),
                     [&path](const ModelFile& file) { return Exists(path / file.name); });
}

bool HasAll(const fs::path& path, const std::array<ModelFile, 3>& files) {
  return std::all_of(files.begin(), files.end(),
                     [&path](const ModelFile& file) { return Exists(path / file.name); });
}

// Prefers the binary format unless only the text files are complete.
const std::array<ModelFile, 3>& ChooseFiles(const fs::path& path) {
  if (!IsFolder(path)) {
    throw InputError(fmt::format("{}: there is no such folder with a COLMAP model", path.string()));
  }
  if (HasAll(path, kBinaryFiles)) return kBinaryFiles;
  if (HasAll(path, kTextFiles)) return kTextFiles;
  if (HasAny(path, kBinaryFiles)) return kBinaryFiles;
  if (HasAny(path, kTextFiles)) return kTextFiles;
  throw InputError(
      fmt::format("{}: holds no COLMAP model (cameras, images and points3D, .bin or .txt){}",
                  path.string(), IsFolder(path / "0") ? "; did you mean its folder 0?" : ""));
}

void WriteFiles(const Model& model, const fs::path& path, const std::array<ModelFile, 3>& files) {
  for (const ModelFile& file : files) {
    WriteFile(path / file.name, [&](std::ostream& out) { file.write(model, out); });
  }
}

}  // namespace

const std::set<std::string>& ModelFileNames() {
  static const std::set<std::string> names = {"cameras.bin",       "images.bin", "points3D.bin",
                                              "cameras.txt",       "images.txt", "points3D.txt",
                                              kUncertaintyFileName};
  return names;
}

Model ReadModel(const std::string& path) {
  Model model;
  for (const ModelFile& file : ChooseFiles(path)) {
    const std::string name = (fs::path(path) / file.name).string();
    CheckInputFile(name, "file of a COLMAP model", kMaxModelFileSize);
    std::ifstream in(name, std::ios::binary);
    if (!in || !IsRegularFile(name)) {
      throw InputError(fmt::format("{}: missing or unreadable; a COLMAP model needs it", name));
    }
    file.read(in, name, &model);
  }
  for (const ModelImage& image : model.images) CheckImageName(image.name, path);
  const std::string fault = FindModelFault(model);
  if (!fault.empty()) {
    throw InputError(fmt::format("{}: the model's files do not fit together: {}", path, fault));
  }
  return model;
}

void WriteModel(const Model& model, const std::string& path, ModelFormat format,
                const std::function<void(const std::string& folder)>& write_more) {
  AtomicFolder folder(path);
  if (format != ModelFormat::kText) WriteFiles(model, folder.TemporaryPath(), kBinaryFiles);
  if (format != ModelFormat::kBinary) WriteFiles(model, folder.TemporaryPath(), kTextFiles);
  if (write_more) write_more(folder.TemporaryPath().string());
  folder.Commit();
}

}  // namespace velamap
