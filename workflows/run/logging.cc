#include "workflows/run/logging.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "importer/text/shown_text.h"
#include "workflows/run/progress.h"

namespace velamap {
namespace {

// `before` is the preceding byte: UTF-8 encodes the control characters U+0080 to U+009F with C2 as
// their first byte.
char PrintableCharacter(char before, char character) {
  const auto code = static_cast<unsigned char>(character);
  const bool is_control = (code < 0x20 && code != '\n' && code != '\t') || code == 0x7f ||
                          (before == '\xc2' && code >= 0x80 && code < 0xa0);
  return is_control ? '?' : character;
}

void WriteToTerminal(const char* text, std::size_t size) {
  const std::string printable = Printable({text, size});
  ClearProgressLine();
  std::fwrite(printable.data(), 1, size, stderr);
  std::fflush(stderr);
}

class TerminalSink : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    WriteToTerminal(line.data(), line.size());
  }
  void flush_() override {}
};

// Keeps the warnings for the verdict.
class WarningSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> Warnings() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return warnings_;
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (message.level != spdlog::level::warn) return;
    warnings_.emplace_back(message.payload.data(), message.payload.size());
  }
  void flush_() override {}

 private:
  std::vector<std::string> warnings_;
};

// Puts `warning: ` or `error: ` before the message of such a level.
class ProblemMark : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    if (message.level < spdlog::level::warn) return;
    const std::string_view mark = message.level == spdlog::level::warn ? "warning: " : "error: ";
    out.append(mark.data(), mark.data() + mark.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<ProblemMark>();
  }
};

// The message without folders and control characters.
class FolderlessText : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const std::string text =
        StripFolders(Printable({message.payload.data(), message.payload.size()}));
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<FolderlessText>();
  }
};

// %* is the mark of a problem, %& the message without folders.
std::unique_ptr<spdlog::formatter> MakeFormatter(const std::string& pattern) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<ProblemMark>('*').add_flag<FolderlessText>('&').set_pattern(pattern);
  return formatter;
}

std::shared_ptr<spdlog::sinks::sink> log_file;
std::shared_ptr<WarningSink> warnings;
spdlog::level::level_enum written_level = spdlog::level::info;  // of terminal and file

}  // namespace

std::string Printable(std::string text) {
  char before = '\0';
  for (char& character : text) {
    character = PrintableCharacter(std::exchange(before, character), character);
  }
  return text;
}

int PrintableOutput::overflow(int character) {
  if (traits_type::eq_int_type(character, traits_type::eof()))
    return traits_type::not_eof(character);
  const char passed = traits_type::to_char_type(character);
  return out_->sputc(PrintableCharacter(std::exchange(before_, passed), passed));
}

void SetUpLogging() {
  auto sink = std::make_shared<TerminalSink>();
  warnings = std::make_shared<WarningSink>();
  auto logger =
      std::make_shared<spdlog::logger>("velamap", spdlog::sinks_init_list{sink, warnings});
  sink->set_formatter(MakeFormatter("[%H:%M:%S] %*%v"));
  spdlog::set_default_logger(logger);
}

void SetLogLevel(LogLevel level) {
  written_level = static_cast<spdlog::level::level_enum>(level);
  spdlog::set_level(std::min(written_level, spdlog::level::warn));
  for (const auto& sink : spdlog::default_logger()->sinks()) {
    if (sink != warnings) sink->set_level(written_level);
  }
}

std::vector<std::string> LoggedWarnings() {
  return warnings == nullptr ? std::vector<std::string>{} : warnings->Warnings();
}

void AddLogFile(const std::string& path) {
  try {
    log_file = std::make_shared<spdlog::sinks::basic_file_sink_mt>(path);
  } catch (const spdlog::spdlog_ex& error) {
    throw InputError(fmt::format("{}: the log cannot be written: {}", path, error.what()));
  }
  log_file->set_level(written_level);
  log_file->set_formatter(MakeFormatter("[%Y-%m-%d %H:%M:%S] %*%&"));
  spdlog::default_logger()->sinks().push_back(log_file);
  spdlog::default_logger()->flush_on(spdlog::level::info);
}

void ReportError(const std::string& message) {
  std::string line = message;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  line = "error: " + line + "\n";
  WriteToTerminal(line.data(), line.size());
  if (log_file == nullptr) return;
  line.pop_back();
  try {
    log_file->log(spdlog::details::log_msg("velamap", spdlog::level::info, line));
    log_file->flush();
  } catch (const spdlog::spdlog_ex&) {
    // The disk is full, and the terminal has the line.
  }
}

}  // namespace velamap
