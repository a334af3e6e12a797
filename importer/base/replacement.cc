#include "importer/base/replacement.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHashDigits = 16;

std::string HashText(std::uint64_t hash) { return fmt::format("{:0{}x}", hash, kHashDigits); }

// The recorded hash of each file; empty if there is no record.
std::map<std::string, std::string> ReadFolderRecord(const fs::path& folder) {
  std::map<std::string, std::string> hash_of_name;
  std::ifstream stream(folder / kFolderRecord);
  for (std::string line; std::getline(stream, line);) {
    if (line.size() <= kHashDigits + 1 || line.front() == '#') continue;
    hash_of_name[line.substr(kHashDigits + 1)] = line.substr(0, kHashDigits);
  }
  return hash_of_name;
}

// The device and number of a file that exists, which all its names share.
using FileId = std::pair<dev_t, ino_t>;

struct Place {
  const UsedPath* used;
  fs::path canonical;
  std::optional<FileId> id;
};

std::vector<Place> PlacesOf(const std::vector<UsedPath>& paths) {
  std::vector<Place> places;
  for (const UsedPath& used : paths) {
    Place place{&used, CanonicalPath(used.path), std::nullopt};
    struct stat status {};
    if (stat(used.path.c_str(), &status) == 0) place.id = {status.st_dev, status.st_ino};
    places.push_back(std::move(place));
  }
  return places;
}

void CheckApart(const Place& output, const Place& other) {
  if (output.canonical == other.canonical || (output.id && output.id == other.id)) {
    throw InputError(fmt::format("{}: {} is the {} too; give another", output.used->used_by,
                                 output.used->path.string(), other.used->used_by));
  }
  if (output.used->is_replaced_folder && IsInside(other.canonical, output.canonical)) {
    throw InputError(fmt::format(
        "{}: {} is replaced as a whole and must not hold the {} ({}); give another folder",
        output.used->used_by, output.used->path.string(), other.used->used_by,
        other.used->path.string()));
  }
}

constexpr char kTemporaryMark[] = ".tmp-";

}  // namespace

bool IsInside(const fs::path& path, const fs::path& folder) {
  const fs::path inner = CanonicalPath(path), outer = CanonicalPath(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

std::string MakeFolderRecord(const fs::path& folder) {
  std::string record;
  for (const fs::path& entry : FolderEntries(folder)) {
    if (!IsRegularFile(entry) || entry.filename() == kFolderRecord) continue;
    record += HashText(HashOfFile(entry)) + ' ' + entry.filename().string() + '\n';
  }
  return record.empty() ? "" : "# files that velamap wrote; it replaces no others\n" + record;
}

void CheckReplaceableFolder(const fs::path& path) {
  if (!Exists(path)) return;
  if (!IsFolder(path)) {
    throw InputError(fmt::format(
        "{}: cannot be written: it exists and is not a folder; choose another output path",
        path.string()));
  }
  const std::map<std::string, std::string> hash_of_name = ReadFolderRecord(path);
  for (const fs::path& entry : FolderEntries(path)) {
    const std::string name = entry.filename().string();
    if (name == kFolderRecord || FinalName(name) != name) continue;
    if (IsFolder(entry) && !IsLink(entry)) {
      CheckReplaceableFolder(entry);
      continue;
    }
    const auto recorded = hash_of_name.find(name);
    const bool is_ours = recorded != hash_of_name.end() && IsRegularFile(entry) && !IsLink(entry);
    if (is_ours && HashText(HashOfFile(entry)) == recorded->second) continue;
    throw InputError(fmt::format(
        "{}: the output folder holds {}, which {}; move it away or choose another folder",
        path.string(), name,
        is_ours ? "was changed after velamap wrote it" : "velamap did not write there"));
  }
}

void CheckOutputs(const std::vector<UsedPath>& inputs, const std::vector<UsedPath>& outputs) {
  const std::vector<Place> input_places = PlacesOf(inputs), output_places = PlacesOf(outputs);
  for (std::size_t i = 0; i < output_places.size(); ++i) {
    for (const Place& input : input_places) CheckApart(output_places[i], input);
    for (std::size_t k = 0; k < output_places.size(); ++k) {
      if (k == i) continue;
      // If both are equal, the later one is named first.
      CheckApart(output_places[std::max(i, k)], output_places[std::min(i, k)]);
      CheckApart(output_places[i], output_places[k]);
    }
  }
  for (const UsedPath& output : outputs) {
    if (output.is_replaced_folder) CheckReplaceableFolder(output.path);
  }
}

void CheckImageName(const std::string& name, const std::string& where) {
  const fs::path path = name;
  const bool leads_out = path.empty() || path.is_absolute() ||
                         name.find('\0') != std::string::npos ||
                         std::find(path.begin(), path.end(), fs::path("..")) != path.end();
  if (!leads_out) return;
  throw InputError(fmt::format(
      "{}: the image name '{}' leads out of the folder of images; names such as day1/a.jpg are "
      "expected",
      where, name.c_str()));
}

std::string TemporaryName(const std::string& name) {
  static std::atomic<int> counter{0};
  return fmt::format(".{}{}{}-{}", name, kTemporaryMark, getpid(), counter++);
}

std::string FinalName(const std::string& name) {
  const std::size_t mark = name.rfind(kTemporaryMark);
  if (name.empty() || name.front() != '.' || mark == std::string::npos || mark <= 1) return name;
  const std::string numbers = name.substr(mark + sizeof(kTemporaryMark) - 1);
  const bool is_ours = numbers.find('-') != std::string::npos &&
                       numbers.find_first_not_of("0123456789-") == std::string::npos;
  return is_ours ? name.substr(1, mark - 1) : name;
}

void RemoveUnfinished(const fs::path& folder) {
  if (!IsFolder(folder)) return;
  for (const fs::path& entry : FolderEntries(folder)) {
    const std::string name = entry.filename().string();
    if (FinalName(name) != name) RemoveAll(entry);
  }
}

}  // namespace velamap
