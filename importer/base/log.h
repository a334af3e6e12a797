// The log of all commands. workflows/run/logging.h sends it to the terminal and a file.
//
// Messages are formatted inside the fmt library, because spdlog's own templates would compile fmt's
// formatting once more in every file that logs.

#pragma once

#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace velamap {

// The numbers are spdlog's.
enum class LogLevel { kDebug = 1, kInfo = 2, kWarn = 3, kError = 4 };

// Whether messages of this level go anywhere.
bool IsLogged(LogLevel level);

void LogMessage(LogLevel level, std::string_view message);

// The same with a message in fmt's syntax, which is only formatted if it is logged.
template <typename First, typename... Rest>
void LogMessage(LogLevel level, fmt::format_string<First, Rest...> format, First&& first,
                Rest&&... rest) {
  if (!IsLogged(level)) return;
  LogMessage(level, fmt::format(format, std::forward<First>(first), std::forward<Rest>(rest)...));
}

inline void LogWarning(std::string_view message) { LogMessage(LogLevel::kWarn, message); }
inline void LogInfo(std::string_view message) { LogMessage(LogLevel::kInfo, message); }
inline void LogDebug(std::string_view message) { LogMessage(LogLevel::kDebug, message); }

template <typename First, typename... Rest>
void LogWarning(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  LogMessage(LogLevel::kWarn, format, std::forward<First>(first), std::forward<Rest>(rest)...);
}
template <typename First, typename... Rest>
void LogInfo(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  LogMessage(LogLevel::kInfo, format, std::forward<First>(first), std::forward<Rest>(rest)...);
}
template <typename First, typename... Rest>
void LogDebug(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  LogMessage(LogLevel::kDebug, format, std::forward<First>(first), std::forward<Rest>(rest)...);
}

}  // namespace velamap
