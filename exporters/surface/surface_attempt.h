// Fits the surfaces of several parts one after the other; one that fails does not stop the others.

#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace velamap {

// Adds the notes that `fit` returns to `notes`, or that `part` has no surface and why. Keeps the
// first error that is not of the data, DataError, in `first_error`.
void TryFitSurface(const std::string& part, const std::function<std::vector<std::string>()>& fit,
                   std::vector<std::string>* notes, std::exception_ptr* first_error);

}  // namespace velamap
