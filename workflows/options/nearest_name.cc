#include "workflows/options/nearest_name.h"

#include <algorithm>
#include <sstream>

namespace velamap {
namespace {

constexpr int kMaxOfWord = 2;  // letters that a whole word counts as

// Smallest cost of turning the sequence `a` into `b` by insertions, deletions and substitutions.
template <typename Sequence, typename Insertion, typename Substitution>
int EditDistance(const Sequence& a, const Sequence& b, const Insertion& insertion,
                 const Substitution& substitution) {
  std::vector<int> row = {0};
  for (const auto& item : b) row.push_back(row.back() + insertion(item));
  for (const auto& item : a) {
    int diagonal = row[0];
    row[0] += insertion(item);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + substitution(item, b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + insertion(item), row[j - 1] + insertion(b[j - 1]), substituted});
    }
  }
  return row.back();
}

int LetterDistance(const std::string& a, const std::string& b) {
  return EditDistance(
      a, b, [](char) { return 1; }, [](char x, char y) { return static_cast<int>(x != y); });
}

std::vector<std::string> Words(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  std::vector<std::string> words;
  std::istringstream stream(name);
  for (std::string word; std::getline(stream, word, '_');) words.push_back(word);
  return words;
}

int WordDistance(const std::string& a, const std::string& b) {
  return EditDistance(
      Words(a), Words(b),
      [](const std::string& word) { return std::min(static_cast<int>(word.size()), kMaxOfWord); },
      LetterDistance);
}

}  // namespace

std::string NearestName(const std::string& text, const std::vector<std::string>& names) {
  std::string nearest;
  int smallest = static_cast<int>(text.size() + 1) / 2;  // beyond half of the letters it is a guess
  for (const std::string& name : names) {
    const int distance = std::min(LetterDistance(text, name), WordDistance(text, name));
    if (distance < smallest || (distance == smallest && nearest.empty())) {
      smallest = distance;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace velamap
