// Reads and writes COLMAP model folders, binary and text: cameras, images and points3D.

#pragma once

#include <functional>
#include <iosfwd>
#include <set>
#include <string>

#include "reconstruct/model/model.h"

namespace velamap {

enum class ModelFormat { kBinary, kText, kBinaryAndText };

// Names of all files that a model folder may hold: where the folder is an input, no output may
// replace one of them (workflows/options/path_check.h).
const std::set<std::string>& ModelFileNames();

// Reads the folder; prefers the binary format where both are there, as COLMAP does. Throws
// InputError that names the file (in text also the line) if anything is missing, truncated or
// inconsistent.
Model ReadModel(const std::string& path);

// Writes a temporary folder and renames it to `path`, so that an interrupted run leaves the old
// model or none. Points and tracks are sorted by id, so that equal models give equal bytes. Text
// has 17 digits and reads back to the same doubles. `write_more` may add files of ModelFileNames()
// to the temporary folder. Throws InputError if the folder cannot be written.
void WriteModel(const Model& model, const std::string& path, ModelFormat format,
                const std::function<void(const std::string& folder)>& write_more = {});

// The single files of a folder. The readers add to `model` and throw InputError that begins with
// `name`.
void ReadCamerasText(std::istream& in, const std::string& name, Model* model);
void ReadImagesText(std::istream& in, const std::string& name, Model* model);
void ReadPoints3DText(std::istream& in, const std::string& name, Model* model);
void WriteCamerasText(const Model& model, std::ostream& out);
void WriteImagesText(const Model& model, std::ostream& out);
void WritePoints3DText(const Model& model, std::ostream& out);

void ReadCamerasBinary(std::istream& in, const std::string& name, Model* model);
void ReadImagesBinary(std::istream& in, const std::string& name, Model* model);
void ReadPoints3DBinary(std::istream& in, const std::string& name, Model* model);
void WriteCamerasBinary(const Model& model, std::ostream& out);
void WriteImagesBinary(const Model& model, std::ostream& out);
void WritePoints3DBinary(const Model& model, std::ostream& out);

}  // namespace velamap
