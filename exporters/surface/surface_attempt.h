// Fits the surfaces of several parts one after the other; one that fails does not stop the others.

#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace velamap {

// Adds the notes that `fit` returns to `notes` or, if it throws, one that says why `part` has no
// surface. Keeps the first exception other than DataError in `first_error`, because the markers did
// not cause it.
void TryFitSurface(const std::string& part, const std::function<std::vector<std::string>()>& fit,
                   std::vector<std::string>* notes, std::exception_ptr* first_error);

}  // namespace velamap
