// Guesses which name a mistyped one was meant to be.

#pragma once

#include <string>
#include <vector>

namespace velamap {

// The known name that is nearest to `text`; "" if none is near. Two letters exchanged count as one.
// A whole word too many or missing, such as the section before the dot, counts as two at most.
std::string NearestName(const std::string& text, const std::vector<std::string>& names);

// "did you mean NAME? " with `dashes` before the nearest name; "" if none is near.
std::string DidYouMean(const std::string& unknown_name, const std::vector<std::string>& names,
                       const std::string& dashes = "");

}  // namespace velamap
