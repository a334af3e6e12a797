#include "exporters/surface/surface_attempt.h"

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

void TryFitSurface(const std::string& part, const std::function<std::vector<std::string>()>& fit,
                   std::vector<std::string>* notes, std::exception_ptr* first_error) {
  try {
    for (const std::string& note : fit()) notes->push_back(fmt::format("{}: {}", part, note));
  } catch (const std::exception& error) {
    notes->push_back(fmt::format("{}: no surface: {}", part, error.what()));
    const bool is_of_data = dynamic_cast<const DataError*>(&error) != nullptr;
    if (!is_of_data && !*first_error) *first_error = std::current_exception();
  }
}

}  // namespace velamap
