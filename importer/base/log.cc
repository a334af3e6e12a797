#include "importer/base/log.h"

#include <spdlog/spdlog.h>

namespace velamap {
namespace {

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  static_assert(static_cast<int>(LogLevel::kDebug) == SPDLOG_LEVEL_DEBUG);
  static_assert(static_cast<int>(LogLevel::kError) == SPDLOG_LEVEL_ERROR);
  return static_cast<spdlog::level::level_enum>(level);
}

}  // namespace

bool IsLogged(LogLevel level) { return spdlog::should_log(SpdlogLevel(level)); }

void LogMessage(LogLevel level, std::string_view message) {
  spdlog::log(SpdlogLevel(level), spdlog::string_view_t(message.data(), message.size()));
}

}  // namespace velamap
