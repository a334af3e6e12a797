#include "importer/import_anew.h"

#include <fstream>
#include <ostream>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/database/colmap_database.h"
#include "importer/import_checks.h"
#include "importer/video/frame_source.h"
#include "importer/video/source_file.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr char kStagedDatabase[] = "database.db", kStagedFrames[] = "frames";

// Written when the new import is complete. If the database is no longer beside it, the database has
// replaced the earlier one, and the steps in the record remain to be done.
constexpr char kReplacementRecord[] = "replacement";

struct Replacement {
  fs::path frame_folder;                          // seen from the folder of the database
  std::map<std::string, std::uint64_t> obsolete;  // files there that have to go, and their hashes
};

fs::path StageOf(const std::string& database_path) {
  const fs::path file = CanonicalPath(database_path);
  return file.parent_path() / ("." + file.filename().string() + ".velamap-anew");
}

// With zero bytes between the texts, because names may hold anything else.
void WriteReplacement(const Replacement& replacement, const fs::path& path) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    out << replacement.frame_folder.string() << '\0';
    for (const auto& [name, hash] : replacement.obsolete) out << name << '\0' << hash << '\0';
  });
}

Replacement ReadReplacement(const fs::path& path) {
  Replacement replacement;
  std::ifstream stream(path, std::ios::binary);
  std::string text, hash;
  if (std::getline(stream, text, '\0')) replacement.frame_folder = text;
  while (std::getline(stream, text, '\0') && std::getline(stream, hash, '\0')) {
    replacement.obsolete[text] = std::strtoull(hash.c_str(), nullptr, 10);
  }
  return replacement;
}

// Can be repeated, because a run may also be killed here.
void MoveFrames(const fs::path& stage) {
  const Replacement replacement = ReadReplacement(stage / kReplacementRecord);
  const fs::path folder = AbsolutePath(stage.parent_path() / replacement.frame_folder);
  if (IsFolder(stage / kStagedFrames)) {
    for (const fs::path& frame : FolderEntries(stage / kStagedFrames)) {
      const fs::path target = folder / frame.filename();
      // Keeps a picture that the user has put there meanwhile.
      if (!Exists(target) || IsWrittenFrame(target)) MoveFile(frame, target);
    }
  }
  for (const auto& [name, hash] : replacement.obsolete) {
    if (IsRegularFile(folder / name) && HashOfFile(folder / name) == hash) RemoveAll(folder / name);
  }
  if (IsFolder(folder)) SyncFileSystem(folder);
}

// Removes the record first: without it, the rest is treated as an unfinished import.
void RemoveStage(const fs::path& stage) {
  RemoveAll(stage / kReplacementRecord);
  RemoveAll(stage);
}

// Whether the copy has the content that the photograph had at the import but no longer has.
bool IsOutdatedCopy(const fs::path& copy, const fs::path& original, const SourceFile& known) {
  return IsRegularFile(copy) && !IsLink(copy) && IsRegularFile(original) &&
         !IsSameFile(copy, original) && !HasSameContent(known, original.string()) &&
         HasSameContent(known, copy.string());
}

// Completes the journal that another program has left, because SQLite would otherwise apply it to
// the new database.
void SettleJournals(const std::string& path) {
  { const ColmapDatabase earlier(path, ColmapDatabase::Mode::kReadWriteCreate); }
  if (Exists(path + "-wal")) {
    throw InputError(fmt::format(
        "{}: another program has it open; close it (the COLMAP GUI?) and run again", path));
  }
  RemoveAll(path + "-journal");
}

}  // namespace

ImportAnew::ImportAnew(const MarkerImporterOptions& options)
    : options_(options), staged_(options), stage_(StageOf(options.database_path)) {
  {
    const ColmapDatabase earlier(options.database_path, ColmapDatabase::Mode::kReadWriteCreate);
    for (const auto& [name, id] : earlier.ReadImageIdsByName()) earlier_names_.push_back(name);
    earlier_sources_ = earlier.ReadSources();
  }
  CheckFrameFolder(options, earlier_names_);
  CreateFolders(stage_);
  staged_.database_path = stage_ / kStagedDatabase;
  if (!options.frame_output_path.empty()) staged_.frame_output_path = stage_ / kStagedFrames;
}

ImportAnew::~ImportAnew() {
  if (!has_replaced_) RemoveStage(stage_);
}

std::vector<std::string> ImportAnew::ObsoleteFiles() const {
  std::vector<std::string> obsolete;
  const fs::path folder = options_.frame_output_path;
  if (folder.empty()) return obsolete;
  const bool is_video = !IsFolder(options_.image_path);  // else the frames may be the photographs
  for (const std::string& name : earlier_names_) {
    const auto known = earlier_sources_.find(name);
    const bool is_old_frame = is_video && NumberOfVideoFrame(name) &&
                              IsWrittenFrame(folder / name) &&
                              !Exists(fs::path(staged_.frame_output_path) / name);
    if (is_old_frame ||
        (options_.is_only_source && known != earlier_sources_.end() &&
         IsOutdatedCopy(folder / name, fs::path(options_.image_path) / name, known->second))) {
      obsolete.push_back(name);
    }
  }
  return obsolete;
}

void ImportAnew::Replace() {
  const fs::path database = CanonicalPath(options_.database_path);
  Replacement replacement;
  const fs::path folder = options_.frame_output_path;
  if (!folder.empty()) {
    replacement.frame_folder = CanonicalPath(folder).lexically_proximate(database.parent_path());
  }
  for (const std::string& name : ObsoleteFiles()) {
    replacement.obsolete[name] = HashOfFile(folder / name);
  }
  WriteReplacement(replacement, stage_ / kReplacementRecord);
  SettleJournals(database.string());
  MoveFile(staged_.database_path, database);
  has_replaced_ = true;
  SyncFileSystem(database.parent_path());
  CompleteReplacement(options_.database_path);
}

void CompleteReplacement(const std::string& database_path) {
  const fs::path stage = StageOf(database_path);
  if (!IsFolder(stage) || IsLink(stage)) return;
  if (Exists(stage / kReplacementRecord) && !Exists(stage / kStagedDatabase)) MoveFrames(stage);
  RemoveStage(stage);
}

}  // namespace velamap
