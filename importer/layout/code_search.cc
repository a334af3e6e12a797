#include "importer/layout/code_search.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/layout/code_rotations.h"

// Most processors count bits with one instruction, but not the oldest that Debian supports, so both
// versions are compiled.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VELAMAP_CLONE_FOR_POPCNT __attribute__((target_clones("popcnt", "default"), flatten))
#else
#define VELAMAP_CLONE_FOR_POPCNT
#endif

namespace velamap {
namespace {

constexpr int kMinBits = 3, kMaxBits = 8;
constexpr int kMaxEnumeratedBits = 4;  // per side; larger codes are drawn at random
constexpr int kThesisNumCodes = 130;
// The number of comparisons of codes, which bounds the time.
constexpr double kMaxGreedyWork = 1e8, kMaxAnnealingWork = 3e8;
constexpr int kMaxAnnealingSteps = 500000;
constexpr std::size_t kMinDrawsPerCode = 20;
constexpr double kFirstTemperature = 1.0, kLastTemperature = 0.15;  // squared missing bits

// The squared number of bits that are missing to the wanted distance.
inline int Shortage(int distance, int wanted) {
  return distance < wanted ? (wanted - distance) * (wanted - distance) : 0;
}

// The distributions of <random> differ between standard libraries; these do not.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  std::uint64_t Bits() { return engine_(); }
  std::size_t Below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  double Fraction() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  template <typename T>
  void Shuffle(std::vector<T>* values) {
    for (std::size_t i = values->size(); i > 1; --i)
      std::swap((*values)[i - 1], (*values)[Below(i)]);
  }

 private:
  std::mt19937_64 engine_;
};

bool IsFarFromAll(const Rotations& code, const std::vector<Rotations>& others, int distance) {
  return std::all_of(others.begin(), others.end(), [&](const Rotations& other) {
    return HammingDistance(other, code) >= distance;
  });
}

// Takes candidates that are far enough from those already taken, until there are `num_codes`. The
// candidates are `all` codes in random order, or random codes if `all` is empty.
VELAMAP_CLONE_FOR_POPCNT bool ChooseGreedily(const CodeSpace& space, std::size_t num_codes,
                                             int distance, const std::vector<Rotations>& all,
                                             Random* random, std::vector<Rotations>* codes) {
  codes->clear();
  std::vector<Rotations> candidates = all;
  random->Shuffle(&candidates);
  const std::size_t num_candidates =
      !all.empty()
          ? all.size()
          : std::max(kMinDrawsPerCode * num_codes,
                     static_cast<std::size_t>(kMaxGreedyWork / (50.0 * double(num_codes) + 1000)));
  for (std::size_t i = 0; i < num_candidates && codes->size() < num_codes; ++i) {
    const Rotations code =
        !all.empty() ? candidates[i] : space.Turned(random->Bits() & space.Mask());
    if (DistanceToItself(code) < std::max(distance, 1)) continue;
    if (IsFarFromAll(code, *codes, distance)) codes->push_back(code);
  }
  return codes->size() == num_codes;
}

// A set of codes, and the shortage of each of them at a wanted distance.
class Annealing {
 public:
  Annealing(const CodeSpace& space, int distance, std::vector<Rotations> codes)
      : space_(space), distance_(distance), codes_(std::move(codes)), missing_(codes_.size()) {
    for (std::size_t i = 0; i < codes_.size(); ++i) missing_[i] = Missing(i, codes_[i]);
  }

  const std::vector<Rotations>& codes() const { return codes_; }

  // Repeatedly changes one or two bits of a code that is too close to others. Keeps changes that do
  // not increase the shortage, and others with a probability that falls over the steps. Returns
  // whether no shortage is left.
  bool Run(int num_steps, Random* random) {
    for (int step = 0; step < num_steps; ++step) {
      const std::size_t idx = FindShort(random);
      if (idx == codes_.size()) return true;
      const double temperature = kFirstTemperature * std::pow(kLastTemperature / kFirstTemperature,
                                                              double(step) / num_steps);
      MarkerCode code = codes_[idx][0] ^ RandomBit(random);
      if (random->Below(2) == 0) code ^= RandomBit(random);
      const Rotations changed = space_.Turned(code);
      const int increase = Missing(idx, changed) - missing_[idx];
      if (increase <= 0 || random->Fraction() < std::exp(-increase / temperature)) {
        Replace(idx, changed);
      }
    }
    return FindShort(random) == codes_.size();
  }

 private:
  MarkerCode RandomBit(Random* random) const {
    return CodeSpace::Bit(
        static_cast<int>(random->Below(static_cast<std::size_t>(space_.NumBits()))));
  }

  // The shortage of `code` if it replaced code `idx`.
  int Missing(std::size_t idx, const Rotations& code) const {
    int missing = 2 * Shortage(DistanceToItself(code), distance_);
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      if (i != idx) missing += Shortage(HammingDistance(codes_[i], code), distance_);
    }
    return missing;
  }

  void Replace(std::size_t idx, const Rotations& code) {
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      if (i == idx) continue;
      missing_[i] += Shortage(HammingDistance(codes_[i], code), distance_) -
                     Shortage(HammingDistance(codes_[i], codes_[idx]), distance_);
    }
    codes_[idx] = code;
    missing_[idx] = Missing(idx, code);
  }

  // The index of a code that is too close to others, the first one from a random place on. Returns
  // the number of codes if there is none.
  std::size_t FindShort(Random* random) const {
    const std::size_t start = random->Below(codes_.size());
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      const std::size_t idx = (start + i) % codes_.size();
      if (missing_[idx] > 0) return idx;
    }
    return codes_.size();
  }

  const CodeSpace& space_;
  int distance_;
  std::vector<Rotations> codes_;
  std::vector<int> missing_;
};

VELAMAP_CLONE_FOR_POPCNT bool Anneal(int num_steps, Random* random, Annealing* annealing) {
  return annealing->Run(num_steps, random);
}

int MinDistance(const std::vector<Rotations>& codes, int num_bits) {
  int distance = num_bits;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      distance = std::min(distance, HammingDistance(codes[i], codes[j]));
    }
  }
  return distance;
}

CodeSet MakeCodeSet(int bits_per_side, const std::vector<Rotations>& codes) {
  CodeSet set;
  set.bits_per_side = bits_per_side;
  for (const Rotations& code : codes) {
    set.codes.push_back(code[0]);
    set.num_symmetric += DistanceToItself(code) == 0;
  }
  set.min_distance = MinDistance(codes, bits_per_side * bits_per_side);
  return set;
}

// All codes: those without symmetry, then those that look the same after half a turn, then those
// that look the same after a quarter turn.
std::vector<Rotations> AllBySymmetry(const CodeSpace& space) {
  std::vector<Rotations> codes = space.All();
  std::stable_sort(codes.begin(), codes.end(), [](const Rotations& a, const Rotations& b) {
    const auto symmetry = [](const Rotations& code) {
      return code[0] == code[1] ? 2 : code[0] == code[2] ? 1 : 0;
    };
    return symmetry(a) < symmetry(b);
  });
  return codes;
}

// Returns all codes without symmetry and the first symmetric ones. To be called if more codes are
// wanted than exist without symmetry.
CodeSet TakeSymmetricCodesToo(const CodeSearchOptions& options) {
  const int bits = options.bits_per_side;
  std::vector<Rotations> codes;
  if (bits <= kMaxEnumeratedBits) codes = AllBySymmetry(CodeSpace(bits));
  const auto num_codes = static_cast<std::size_t>(options.num_codes);
  const std::int64_t num_asymmetric = NumAsymmetricCodes(bits);
  if (!options.allow_symmetric || codes.size() < num_codes) {
    throw InputError(fmt::format(
        "{}: {} codes are wanted; {}x{} bits have {} that look different when turned{}",
        OptionName(&CodeSearchOptions::bits_per_side), num_codes, bits, bits, num_asymmetric,
        codes.size() < num_codes
            ? fmt::format(" and {} in all; give more bits", codes.size())
            : fmt::format("; give more bits, or {} 1 to take some of the {} others, whose rotation "
                          "has to be found from their neighbours",
                          OptionName(&CodeSearchOptions::allow_symmetric),
                          static_cast<std::int64_t>(codes.size()) - num_asymmetric)));
  }
  codes.resize(num_codes);
  return MakeCodeSet(bits, codes);
}

}  // namespace

void CodeSearchOptions::Check() const {
  CheckRanges(*this);
  if (bits_per_side == 1 || bits_per_side == 2) {
    throw InputError(fmt::format("{}: {} bits per side allow too few codes; give {} to {}",
                                 OptionName(&CodeSearchOptions::bits_per_side), bits_per_side,
                                 kMinBits, kMaxBits));
  }
}

OptionGroup DescribeOptions(CodeSearchOptions* options) {
  return {"Custom dictionary",
          {{"CustomDictionary.bits", &options->bits_per_side, "cells",
            "makes a dictionary of 3x3 to 8x8 bits whose codes differ as much as possible; give "
            "the cells per side; 0: --dictionary is used",
            FromTo(0, kMaxBits)},
           {"CustomDictionary.size", &options->num_codes, "count",
            "number of its codes; 0: as many as markers are printed", FromTo(0, kMaxMarkerId + 1)},
           {"CustomDictionary.allow_symmetric", &options->allow_symmetric, "0|1",
            "3x3 bits: take codes that look the same when turned where the 120 others do not "
            "suffice"}}};
}

std::int64_t NumAsymmetricCodes(int bits_per_side) {
  const int num_bits = bits_per_side * bits_per_side;
  // A code that looks the same after a quarter turn also does so after half a turn.
  const double num_all = std::pow(2.0, num_bits);
  const double num_half_turn = std::pow(2.0, (num_bits + 1) / 2);
  // The number for 8x8 bits is not exact in a double, but fits into an int64.
  return static_cast<std::int64_t>((num_all - num_half_turn) / 4);
}

CodeSet FindCodes(const CodeSearchOptions& options, std::uint32_t seed) {
  options.Check();
  VELAMAP_CHECK(options.bits_per_side >= kMinBits && options.num_codes >= 1);
  if (options.num_codes > NumAsymmetricCodes(options.bits_per_side)) {
    return TakeSymmetricCodesToo(options);
  }
  const CodeSpace space(options.bits_per_side);
  const auto num_codes = static_cast<std::size_t>(options.num_codes);
  const std::vector<Rotations> all =
      options.bits_per_side <= kMaxEnumeratedBits ? space.All() : std::vector<Rotations>();
  Random random(seed);
  std::vector<Rotations> codes;
  // No set of codes has a minimum distance much above half the number of bits.
  int distance = space.NumBits() / 2 + 4;
  while (!ChooseGreedily(space, num_codes, distance, all, &random, &codes)) {
    VELAMAP_CHECK(--distance >= 1);
  }
  const int num_steps =
      static_cast<int>(std::min<double>(kMaxAnnealingSteps, kMaxAnnealingWork / double(num_codes)));
  while (true) {
    Annealing annealing(space, ++distance, codes);
    if (!Anneal(num_steps, &random, &annealing)) break;
    codes = annealing.codes();
  }
  return MakeCodeSet(options.bits_per_side, codes);
}

CodeSet ThesisCodes() {
  constexpr int kBits = 3;
  std::vector<Rotations> codes = AllBySymmetry(CodeSpace(kBits));
  codes.resize(kThesisNumCodes);
  return MakeCodeSet(kBits, codes);
}

}  // namespace velamap
