#include "importer/text/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <sstream>

#include <fmt/format.h>

namespace velamap {
namespace {

constexpr int kMaxWordCost = 2;  // the most that a whole word costs, in letters

// Smallest cost of turning the sequence `a` into `b` by insertions, deletions, substitutions and
// exchanges of neighbours, which cost as much as an insertion.
template <typename Sequence, typename Insertion, typename Substitution>
int EditDistance(const Sequence& a, const Sequence& b, const Insertion& insertion,
                 const Substitution& substitution) {
  // distances[i][j]: of the first i items of `a` from the first j of `b`.
  std::vector<std::vector<int>> distances(a.size() + 1, std::vector<int>(b.size() + 1, 0));
  for (std::size_t i = 0; i < a.size(); ++i) {
    distances[i + 1][0] = distances[i][0] + insertion(a[i]);
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    distances[0][j + 1] = distances[0][j] + insertion(b[j]);
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      int& distance = distances[i][j];
      distance = std::min({distances[i - 1][j] + insertion(a[i - 1]),
                           distances[i][j - 1] + insertion(b[j - 1]),
                           distances[i - 1][j - 1] + substitution(a[i - 1], b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        distance = std::min(distance, distances[i - 2][j - 2] + insertion(a[i - 1]));
      }
    }
  }
  return distances[a.size()][b.size()];
}

// The cost of inserting or deleting these words.
int Cost(const std::string& word) { return std::min(static_cast<int>(word.size()), kMaxWordCost); }

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

// Returns nothing for names that have no word in common, however few their words are.
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
  // Beyond half of the letters it is a guess, and so is any name for a single letter.
  const int num_letters = static_cast<int>(text.size());
  int smallest = std::min((num_letters + 1) / 2, num_letters - 1);
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

std::string DidYouMean(const std::string& unknown_name, const std::vector<std::string>& names,
                       const std::string& dashes) {
  const std::string nearest = NearestName(unknown_name, names);
  return nearest.empty() ? "" : fmt::format("did you mean {}{}? ", dashes, nearest);
}

}  // namespace velamap
