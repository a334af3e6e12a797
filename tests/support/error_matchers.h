// Checks that bad input gives an error message of one line.

#pragma once

#include <functional>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace velamap {

// Expects that `action` throws Error with a message of one line that contains all of `parts`.
template <typename Error>
void ExpectThrows(const std::function<void()>& action, std::initializer_list<std::string> parts) {
  try {
    action();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos)
          << "'" << part << "' is missing in: " << message;
    }
  }
}

}  // namespace velamap
