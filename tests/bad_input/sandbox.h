// A folder with one good file of each kind, which the cases of bad input spoil:
//
//   images/ clip.avi camera.yml layout.yml   rendered pictures of a board, and the same as a video
//   grey/                                    pictures without a marker
//   workspace/                               what automatic_reconstructor makes of images/

#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "tests/workflows/run_velamap.h"

namespace velamap {

namespace fs = std::filesystem;

struct BadInput {
  std::string name;     // of the case, letters and digits
  std::string command;  // arguments of velamap; @ stands for the folder
  int exit_code = 2;
  std::string word;  // in the one line of the error
  std::function<void(const fs::path& dir)> spoil = {};
  std::vector<std::string> may_change = {};  // files that may be new or other than before
};

inline void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }

// The calls that succeed in the sandbox.
inline const std::string kRerun =
    "automatic_reconstructor --image_path @/images --camera_path @/camera.yml --layout_path "
    "@/layout.yml --backend markers --workspace_path @/workspace";
inline const std::string kImport =
    "marker_importer --image_path @/images --camera_path @/camera.yml --layout_path @/layout.yml "
    "--database_path @/new.db";

// The main job. On the pictures of grey/ it fails because they show no marker.
inline std::string MainJob(
    const std::string& image_path, const std::string& camera_path,
    const std::string& markers = "--dictionary DICT_4X4_50 --marker_length 0.1") {
  return "automatic_reconstructor --image_path @/" + image_path + " --camera_path @/" +
         camera_path + " --workspace_path @/new " + markers;
}
inline const std::string kMainJob = MainJob("grey", "camera.yml");

// Makes the folder, which is empty before.
void MakeSandbox(const fs::path& dir);

// A clip of the board of the sandbox, for its camera and layout.
void WriteLongClip(int num_frames, const fs::path& path);

std::vector<std::string> ArgumentsIn(const fs::path& dir, const std::string& command);

// The hash of each file below, by its path in `dir`; of a link where it leads.
std::map<std::string, std::string> ContentOf(const fs::path& dir);

// Steps of `spoil`, and one that writes a file.
void Replace(const fs::path& file, const std::string& from, const std::string& to);
void RunSql(const fs::path& database, const std::string& sql);
std::function<void(const fs::path& dir)> Write(const std::string& name, const std::string& text);

std::vector<BadInput> OutputCases();
std::vector<BadInput> SourceCases();
std::vector<BadInput> InputCases();
std::vector<BadInput> FileCases();
std::vector<BadInput> ProcessCases();
std::vector<BadInput> CommandCases();
std::vector<BadInput> WishCases();

}  // namespace velamap
