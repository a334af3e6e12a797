#include "workflows/options/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <optional>
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

// What it costs to write these words, or to strike them out.
int Cost(const std::string& word) { return std::min(static_cast<int>(word.size()), kMaxOfWord); }

int Cost(const std::vector<std::string>& words) {
  return std::accumulate(words.begin(), words.end(), 0,
                         [](int sum, const std::string& word) { return sum + Cost(word); });
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

// Nothing for names that have no word in common, however few their words are.
std::optional<int> WordDistance(const std::string& a, const std::string& b) {
  const std::vector<std::string> words1 = Words(a), words2 = Words(b);
  const int distance = EditDistance(
      words1, words2, [](const std::string& word) { return Cost(word); }, LetterDistance);
  if (distance >= Cost(words1) + Cost(words2)) return std::nullopt;
  return distance;
}

}  // namespace

std::string NearestName(const std::string& text, const std::vector<std::string>& names) {
  std::string nearest;
  int smallest = static_cast<int>(text.size() + 1) / 2;  // beyond half of the letters it is a guess
  for (const std::string& name : names) {
    if (name == text) continue;
    const int by_letters = LetterDistance(text, name);
    const int distance = std::min(by_letters, WordDistance(text, name).value_or(by_letters));
    if (distance < smallest || (distance == smallest && nearest.empty())) {
      smallest = distance;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace velamap
