#include "workflows/run/summary.h"

#include <gtest/gtest.h>

#include "workflows/run/run_summary.h"

namespace velamap {
namespace {

TEST(LeftOutTextTest, CountsReasonsThatDifferInNumbersTogether) {
  EXPECT_EQ(LeftOutText({}), "none");
  EXPECT_EQ(LeftOutText({{"a.jpg", "shares 1 of 3 markers"},
                         {"b.jpg", "no marker found"},
                         {"c.jpg", "shares 0 of 12 markers"}}),
            "3; 2: shares 1 of 3 markers (a.jpg, c.jpg); 1: no marker found (b.jpg)");
}

TEST(LeftOutTextTest, MarkersAreCountedByReasonToo) {
  EXPECT_EQ(LeftOutText(NamedById({})), "none");
  EXPECT_EQ(LeftOutText(NamedById({{7, 3, "on line h1 it is 3.50 m from marker 6", true},
                                   {12, 4, "on line h2 it is 2.10 m from marker 11", true},
                                   {90, 1, "seen in 1 registered frames", false}}),
                        "marker"),
            "3; 2: on line h1 it is 3.50 m from marker 6 (markers 7, 12); 1: seen in 1 registered "
            "frames (marker 90)");
}

TEST(LeftOutTextTest, ShowsTheFirstNamesOnly) {
  EXPECT_EQ(LeftOutText({{"a", "r"}, {"b", "r"}, {"c", "r"}, {"d", "r"}}), "4: r (a, b, c, ...)");
}

TEST(LeftOutTextTest, SaysTheNumberOnceForOneReason) {
  EXPECT_EQ(LeftOutText({{"17", "its side is 2.00 times as long"}}, "marker"),
            "1: its side is 2.00 times as long (marker 17)");
}

TEST(FoundCameraTextTest, OnlyAGoodCameraServesTheNextClip) {
  EstimatedCamera found{{CameraModel::kSimplePinhole, 100, 100, {100, 50, 50}}, {0.9, 0.1, 0.1}};
  Verdict verdict;
  const auto serves = [&] {
    const std::string text = FoundCameraText(found, verdict, "camera.yml");
    const bool says_yes = text.find("; camera.yml serves the next clip") != std::string::npos;
    const bool says_no = text.find("; camera.yml is not good enough") != std::string::npos;
    EXPECT_NE(says_yes, says_no) << text;
    return says_yes;
  };
  EXPECT_TRUE(serves());
  verdict.level = ReportStatus::kCheck;
  EXPECT_TRUE(serves());
  verdict.level = ReportStatus::kBad;
  EXPECT_FALSE(serves());
  verdict.level = ReportStatus::kGood;
  found.sigmas.front() = 1.1;
  EXPECT_FALSE(serves());
}

TEST(ShellQuoteTest, QuotesOnlyWhatAShellWouldTakeApart) {
  EXPECT_EQ(ShellQuote("/a/b-c_1.db"), "/a/b-c_1.db");
  EXPECT_EQ(ShellQuote("my photos"), "'my photos'");
  EXPECT_EQ(ShellQuote("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellQuote(""), "''");
}

}  // namespace
}  // namespace velamap
