// Sets a locale with decimal commas and grouped thousands for C++ streams created in its scope, and
// for C if one is installed.

#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace velamap {

class CommaLocale {
 public:
  CommaLocale()
      : previous_(std::locale::global(std::locale(std::locale::classic(), new Facet))),
        previous_c_(std::setlocale(LC_ALL, nullptr)) {
    std::setlocale(LC_ALL, "de_DE.UTF-8");
  }
  ~CommaLocale() {
    std::locale::global(previous_);
    std::setlocale(LC_ALL, previous_c_.c_str());
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  class Facet : public std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };

  std::locale previous_;
  std::string previous_c_;
};

}  // namespace velamap
