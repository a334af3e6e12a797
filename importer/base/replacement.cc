#include "importer/base/replacement.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <regex>
#include <set>
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

constexpr char kSeal[] = "as velamap wrote it: ";

std::string ReadBytes(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool IsProposedLayout(const std::string& text) {
  return text.rfind(std::string("# ") + kProposedLayout, 0) == 0;
}

bool BeginsAsOneOfOurs(const std::string& text) {
  const auto begins = [&](const std::string& with) { return text.rfind(with, 0) == 0; };
  const std::string first_line = text.substr(0, text.find('\n'));
  const std::size_t title = text.find("<title>");
  const std::string title_line =
      title == std::string::npos ? "" : text.substr(title, text.find("</title>", title) - title);
  return begins("image_name,registered,num_markers,") ||   // registration.csv
         begins("[\n {\n  \"stage\": \"") ||               // timing.json
         begins("%YAML:1.0\n---\n# found by velamap ") ||  // camera.yml
         begins("%YAML:1.0\n---\n# velamap camera_calibrator: ") || IsProposedLayout(text) ||
         (begins("<!DOCTYPE html>") &&  // report, page of a camera
          title_line.find("velamap") != std::string::npos) ||
         (begins("$ ") && first_line.find(" bundle_adjuster ") != std::string::npos);  // colmap.log
}

// Also true for a text without a seal, because earlier versions wrote none, but not for a layout,
// because people edit layouts.
bool HasItsSeal(const std::string& text) {
  const std::size_t seal = text.rfind(kSeal);
  if (seal == std::string::npos) return !IsProposedLayout(text);
  constexpr std::size_t kLongestEnd = 5;                // " -->" and the end of the line
  const std::size_t line = text.rfind('\n', seal) + 1;  // 0 if there is none
  const std::size_t hash = seal + sizeof(kSeal) - 1;
  return text.size() <= hash + kHashDigits + kLongestEnd &&
         text.substr(hash, kHashDigits) == HashText(Hash(text.substr(0, line)));
}

// Whether the path is a table or log that the commands for single steps write beside their results.
bool IsTableOrLogOfOurs(const fs::path& path) {
  const bool is_name = path.filename() == "registration.csv" || path.filename() == "colmap.log";
  return is_name && IsRegularFile(path) && !IsLink(path) && BeginsAsOneOfOurs(ReadBytes(path));
}

// Device and inode of an existing file, which are the same for all of its names.
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
    throw InputError(fmt::format("{}: {} is also the {}; give another", output.used->used_by,
                                 output.used->path.string(), other.used->used_by));
  }
  if (output.used->is_replaced_folder && IsInside(other.canonical, output.canonical)) {
    throw InputError(fmt::format(
        "{}: {} is replaced as a whole and must not hold the {} ({}); give another folder",
        output.used->used_by, output.used->path.string(), other.used->used_by,
        other.used->path.string()));
  }
}

// The name of unfinished output: .NAME.velamap-tmp-MACHINE-PROCESS-COUNT, and of SQLite's files
// beside an unfinished database.
constexpr char kTemporaryMark[] = ".velamap-tmp-";

struct UnfinishedName {
  std::string final_name, machine;
  pid_t process_id = 0;
};

// Identifies the machine and the container, because several may share a folder and each numbers its
// processes separately.
std::string ThisMachine() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  gethostname(name.data(), name.size() - 1);
  std::string id;
  std::ifstream("/etc/machine-id") >> id;
  std::array<char, 64> processes{};
  if (readlink("/proc/self/ns/pid", processes.data(), processes.size() - 1) < 0) processes = {};
  return HashText(Hash(fmt::format("{} {} {}", name.data(), id, processes.data())));
}

std::optional<UnfinishedName> ParseUnfinished(const std::string& name) {
  static const std::regex pattern(
      R"(\.(.+)\.velamap-tmp-([0-9a-f]{16})-([0-9]{1,9})-[0-9]{1,9}(-journal|-wal|-shm)?)");
  std::smatch match;
  if (name.find(kTemporaryMark) == std::string::npos || !std::regex_match(name, match, pattern)) {
    return std::nullopt;
  }
  return UnfinishedName{match[1], match[2], static_cast<pid_t>(std::stol(match[3]))};
}

bool IsAbandoned(const UnfinishedName& name) {
  return name.machine == ThisMachine() && kill(name.process_id, 0) != 0 && errno == ESRCH;
}

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
  CheckNotProtected(path);
  const std::map<std::string, std::string> hash_of_name = ReadFolderRecord(path);
  for (const fs::path& entry : FolderEntries(path)) {
    const std::string name = entry.filename().string();
    if (name == kFolderRecord || ParseUnfinished(name)) continue;
    if (IsFolder(entry) && !IsLink(entry)) {
      CheckReplaceableFolder(entry);
      continue;
    }
    const auto recorded = hash_of_name.find(name);
    const bool is_ours = recorded != hash_of_name.end() && IsRegularFile(entry) && !IsLink(entry);
    if (is_ours && HashText(HashOfFile(entry)) == recorded->second) continue;
    if (recorded == hash_of_name.end() && IsTableOrLogOfOurs(entry)) continue;
    throw InputError(fmt::format(
        "{}: the output folder holds {}, which {}; move it away or choose another folder",
        path.string(), name,
        is_ours ? "was changed after velamap wrote it" : "velamap did not write there"));
  }
}

bool IsOwnFile(const fs::path& path) {
  const std::string text = IsRegularFile(path) ? ReadBytes(path) : "";
  return !text.empty() && BeginsAsOneOfOurs(text) && HasItsSeal(text);
}

void CheckOwnFile(const std::string& used_by, const fs::path& path) {
  if (!IsRegularFile(path) || FileSize(path) == 0 || IsOwnFile(path)) return;
  const bool is_ours = BeginsAsOneOfOurs(ReadBytes(path));
  throw InputError(fmt::format(
      "{}: {} would be replaced, but {}; move it away, or choose another place", used_by,
      path.string(), is_ours ? "was changed after velamap wrote it" : "velamap did not write it"));
}

std::string WithSeal(const std::string& text, const std::string& comment_begin,
                     const std::string& comment_end) {
  const std::string body = text.empty() || text.back() == '\n' ? text : text + '\n';
  return body + comment_begin + kSeal + HashText(Hash(body)) + comment_end + '\n';
}

void CheckOutputs(const std::vector<UsedPath>& inputs, const std::vector<UsedPath>& outputs) {
  const std::vector<Place> input_places = PlacesOf(inputs), output_places = PlacesOf(outputs);
  for (std::size_t i = 0; i < output_places.size(); ++i) {
    for (const Place& input : input_places) CheckApart(output_places[i], input);
    for (std::size_t k = 0; k < output_places.size(); ++k) {
      if (k == i) continue;
      // The message names the later one first if both are equal.
      CheckApart(output_places[std::max(i, k)], output_places[std::min(i, k)]);
      CheckApart(output_places[i], output_places[k]);
    }
  }
  for (const UsedPath& output : outputs) {
    if (output.is_replaced_folder) {
      CheckReplaceableFolder(output.path);
    } else if (IsRegularFile(output.path)) {
      CheckNotProtected(output.path);
    }
    if (output.replaces_only_own) CheckOwnFile(output.used_by, output.path);
  }
}

void CheckImageName(const std::string& name, const std::string& where) {
  const fs::path path = name;
  const bool leads_out = path.empty() || path.is_absolute() ||
                         name.find('\0') != std::string::npos ||
                         std::find(path.begin(), path.end(), fs::path("..")) != path.end();
  const std::size_t line_break = name.find_first_of("\r\n");
  if (line_break != std::string::npos) {
    throw InputError(
        fmt::format("{}: the name of the image '{}...' holds a line break, where lists of images "
                    "end a line; rename the image",
                    where, name.substr(0, line_break)));
  }
  if (!leads_out) return;
  throw InputError(fmt::format(
      "{}: the image name '{}' leads out of the folder of images; names such as day1/a.jpg are "
      "expected",
      where, name.c_str()));
}

void CheckNotProtected(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return;
  // The first test also holds for the administrator, who may write everything.
  constexpr mode_t kWritable = S_IWUSR | S_IWGRP | S_IWOTH;
  if ((status.st_mode & kWritable) != 0 && access(path.c_str(), W_OK) == 0) return;
  throw InputError(
      fmt::format("{}: cannot be written: it is write-protected; choose another output path, or "
                  "change its permissions (chmod u+w)",
                  path.string()));
}

fs::path TemporarySibling(const fs::path& path) {
  static int counter = 0;
  static std::mutex mutex;
  static std::set<fs::path> cleared;
  const fs::path folder = path.parent_path();
  const std::lock_guard<std::mutex> lock(mutex);
  if (cleared.insert(folder).second) {
    try {
      RemoveUnfinished(folder);
    } catch (const InputError&) {
      // A folder that cannot be listed may still be writable.
    }
  }
  constexpr std::size_t kMaxNameSize = 180;  // with what is added, a name has at most 255 bytes
  return folder / fmt::format(".{}{}{}-{}-{}", path.filename().string().substr(0, kMaxNameSize),
                              kTemporaryMark, ThisMachine(), getpid(), counter++);
}

fs::path FinalPath(const fs::path& path) {
  fs::path final_path;
  for (const fs::path& component : path) {
    const std::optional<UnfinishedName> unfinished = ParseUnfinished(component.string());
    final_path /= unfinished ? fs::path(unfinished->final_name) : component;
  }
  return final_path;
}

void RemoveUnfinished(const fs::path& folder) {
  if (!IsFolder(folder)) return;
  for (const fs::path& entry : FolderEntries(folder)) {
    const std::optional<UnfinishedName> name = ParseUnfinished(entry.filename().string());
    if (name && IsAbandoned(*name)) RemoveAll(entry);
  }
}

}  // namespace velamap
