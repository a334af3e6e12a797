// COLMAP model folders, binary and text: cameras, images, points3D (the three classic files only).

#pragma once

#include <functional>
#include <iosfwd>
#include <set>
#include <string>

#include "reconstruct/model/model.h"

namespace velamap {

enum class ModelFormat { kBinary, kText, kBinaryAndText };

// Names of all files that a model folder may hold: what CheckReplaceableFolder() asks for.
const std::set<std::string>& ModelFileNames();

// Reads the folder; binary wins where both formats are there, as in COLMAP. Throws InputError that
// names the file (and the line in text) for anything missing, truncated or inconsistent.
Model ReadModel(const std::string& path);

// Writes into a temporary sibling and renames it to `path`, so that an interrupted run leaves the
// old model or none. Points and tracks are sorted by id: same model, same bytes. Text carries 17
// digits and reads back to the same doubles. `write_more` may add files of ModelFileNames() to the
// folder that it is given. Throws InputError if the folder cannot be written.
void WriteModel(const Model& model, const std::string& path, ModelFormat format,
                const std::function<void(const std::string& folder)>& write_more = {});

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
