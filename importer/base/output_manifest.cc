#include "importer/base/output_manifest.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/checksum.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/text_file.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr char kManifest[] = "velamap_files.txt";

using Manifest = std::map<std::string, std::string>;  // checksum by path

std::string ChecksumText(const std::string& content) {
  return fmt::format("{:016x}", Checksum(content));
}

Manifest ReadManifest(const fs::path& folder) {
  Manifest manifest;
  const fs::path path = folder / kManifest;
  if (!IsRegularFile(path)) return manifest;
  std::istringstream lines(ReadTextFile(path.string(), "list of files"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    if (line.empty() || line.front() == '#' || space == std::string::npos) continue;
    manifest[line.substr(space + 1)] = line.substr(0, space);
  }
  manifest[kManifest] = "";
  return manifest;
}

void CheckEntries(const fs::path& folder, const std::string& below, const Manifest& manifest) {
  for (const fs::path& entry : FolderEntries(folder / below)) {
    const std::string name = below + entry.filename().string();
    if (IsFolder(entry)) {
      CheckEntries(folder, name + "/", manifest);
      continue;
    }
    const auto known = manifest.find(name);
    if (known == manifest.end()) {
      throw InputError(fmt::format(
          "{}: the output folder holds {}, which velamap did not write there; choose another "
          "folder or empty it",
          folder.string(), name));
    }
    if (name == kManifest) continue;
    const bool is_same = FileSize(entry) == 0
                             ? known->second == ChecksumText("")
                             : known->second == ChecksumText(ReadTextFile(entry.string(), "file"));
    if (is_same) continue;
    throw InputError(fmt::format(
        "{}: {} has been changed since velamap wrote it; choose another folder, or move "
        "the file away",
        folder.string(), name));
  }
}

}  // namespace

void CheckOutputFolder(const fs::path& folder) {
  if (!Exists(folder)) return;
  if (!IsFolder(folder)) {
    throw InputError(
        fmt::format("{}: cannot be written: it exists and is no folder; choose another "
                    "output path",
                    folder.string()));
  }
  CheckEntries(folder, "", ReadManifest(folder));
}

void CheckInputOutside(const std::string& input_path, const fs::path& folder) {
  if (input_path.empty() || !Exists(input_path) || !Exists(folder)) return;
  const fs::path input = CanonicalPath(input_path);
  const fs::path canonical = CanonicalPath(AbsoluteFolder(folder));
  const auto [rest, end] =
      std::mismatch(canonical.begin(), canonical.end(), input.begin(), input.end());
  if (rest != canonical.end()) return;
  throw InputError(
      fmt::format("{}: lies in the output folder {}, which is replaced; choose another "
                  "output path",
                  input_path, folder.string()));
}

void WriteOutputFolder(const fs::path& folder, const OutputFiles& files) {
  AtomicFolder output(folder);
  std::string manifest =
      "# What velamap wrote into this folder, with checksums: a later run replaces the folder only "
      "if nothing else is in it and nothing has been changed.\n";
  for (const auto& [name, content] : files) {
    const fs::path path = output.TemporaryPath() / name;
    CreateFolders(path.parent_path());
    WriteFile(path, [&text = content](std::ostream& out) { out << text; });
    manifest += fmt::format("{} {}\n", ChecksumText(content), name);
  }
  WriteFile(output.TemporaryPath() / kManifest, [&](std::ostream& out) { out << manifest; });
  output.Commit();
}

}  // namespace velamap
