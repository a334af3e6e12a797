#include "importer/text/shown_text.h"

#include <algorithm>
#include <functional>
#include <mutex>
#include <set>

#include "importer/base/files.h"

namespace velamap {
namespace {

std::mutex mutex;
bool shows_folders = false;
// With a slash at the end. Folders sort after their parents, so the order is reversed to find the
// longest first.
std::set<std::string, std::greater<>> mentioned_folders;

constexpr char kEndsOfWords[] = " \t\r\n'\"`,;=()[]{}<>|";

// Whether `i` is the beginning of a word, where a path may begin.
bool BeginsWord(const std::string& text, std::size_t i) {
  return i == 0 || text[i - 1] == ':' ||
         std::string(kEndsOfWords).find(text[i - 1]) != std::string::npos;
}

void EraseAll(const std::string& folder, std::string* text) {
  for (std::size_t i = text->find(folder); i != std::string::npos; i = text->find(folder, i)) {
    if (BeginsWord(*text, i)) {
      text->erase(i, folder.size());
    } else {
      ++i;
    }
  }
}

}  // namespace

void ShowFolders(bool show) {
  const std::lock_guard<std::mutex> lock(mutex);
  shows_folders = show;
}

void RegisterPrivatePath(const std::filesystem::path& path) {
  const std::lock_guard<std::mutex> lock(mutex);
  for (const std::filesystem::path& form : {AbsoluteFolder(path), CanonicalPath(path)}) {
    const std::filesystem::path folder = form.parent_path();
    if (folder.has_relative_path()) mentioned_folders.insert(folder.string() + '/');
  }
}

std::string StripFolders(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (shows_folders) return text;
  std::string shown = text;
  for (const std::string& folder : mentioned_folders) EraseAll(folder, &shown);
  for (std::size_t begin = shown.find('/'); begin != std::string::npos;
       begin = shown.find('/', begin + 1)) {
    if (!BeginsWord(shown, begin)) continue;
    const std::size_t end = std::min(shown.find_first_of(kEndsOfWords, begin), shown.size());
    const std::string word = shown.substr(begin, end - begin);
    // A slash at the end belongs to the name. Two at the beginning belong to an address.
    const std::size_t name = word.size() > 1 ? word.rfind('/', word.size() - 2) : 0;
    if (word.size() > 1 && word[1] != '/') shown.erase(begin, name + 1);
  }
  return shown;
}

}  // namespace velamap
