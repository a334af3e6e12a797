#include "importer/process/child_process.h"

#include <sys/wait.h>

#include <chrono>
#include <optional>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

namespace velamap {
namespace {

using namespace std::chrono_literals;

ChildProcess::Time After(std::chrono::milliseconds duration) {
  return std::chrono::steady_clock::now() + duration;
}

std::string ReadAll(const ChildProcess& process) {
  std::string text;
  for (;;) {
    const std::optional<std::string> part = process.Read(After(20s));
    if (!part) return text + " (still running)";
    if (part->empty()) return text;
    text += *part;
  }
}

TEST(ChildProcess, GivesBothOutputsAndTheStatus) {
  const ChildProcess process({"sh", "-c", "echo out; echo err >&2; exit 3"},
                             {"PATH=/usr/bin:/bin"});
  const std::string text = ReadAll(process);
  EXPECT_NE(text.find("out\n"), std::string::npos) << text;
  EXPECT_NE(text.find("err\n"), std::string::npos) << text;
  const std::optional<int> status = process.Wait(After(20s));
  ASSERT_TRUE(status);
  EXPECT_TRUE(WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 3);
}

TEST(ChildProcess, SeesOnlyTheVariablesThatItGetsAndAnEmptyInput) {
  const ChildProcess process({"sh", "-c", "cat; echo \"[$A][$HOME]\""},
                             {"PATH=/usr/bin:/bin", "A=1"});
  EXPECT_EQ(ReadAll(process), "[1][]\n");
}

// The words reach the program as they are, whatever a shell would make of them.
TEST(ChildProcess, StartsNoShell) {
  const ChildProcess process({"printf", "%s", "$(echo a) * 'b' \"c\""}, {"PATH=/usr/bin:/bin"});
  EXPECT_EQ(ReadAll(process), "$(echo a) * 'b' \"c\"");
}

TEST(ChildProcess, ADeadlineIsKept) {
  const ChildProcess process({"sleep", "30"}, {"PATH=/usr/bin:/bin"});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(process.Read(After(100ms)));
  EXPECT_FALSE(process.Wait(After(100ms)));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
}

TEST(ChildProcess, AProgramThatDoesNotExistIsAnError) {
  const ChildProcess process({"/no/such/program"}, {});
  EXPECT_THROW(process.Wait(After(20s)), std::system_error);
}

// Otherwise the output would stay open for as long as what the program has started.
TEST(ChildProcess, WhatTheProgramHasStartedEndsWithIt) {
  const ChildProcess process({"sh", "-c", "sleep 60 & echo started"}, {"PATH=/usr/bin:/bin"});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(ReadAll(process), "started\n");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
}

}  // namespace
}  // namespace velamap
