// Pages in headless Chromium, which draws WebGL in software.

#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {

// Tests of the pages in a folder, which a test suite makes in *dir_; skipped where no Chromium is
// on the PATH.
class BrowserTest : public testing::Test {
 protected:
  static void TearDownTestSuite() { delete dir_; }

  void SetUp() override;

  // Opens the page without a network and returns the run; its console must stay silent, but for the
  // graphics driver's remarks on taking pictures.
  ProgramRun Open(const std::string& page, std::vector<std::string> arguments) const;

  // A picture of the page, which stays for whoever wants to look.
  cv::Mat Screenshot(const std::string& page, int width, int height, const std::string& name,
                     std::vector<std::string> more = {}) const;

  static TempDir* dir_;

 private:
  std::string browser_;
};

// A page as the srcdoc of an iframe.
std::string EscapedForAttribute(const std::string& text);

// Part of the pixels that differ by more than a shade.
double PartThatDiffers(const cv::Mat& a, const cv::Mat& b);

// Part of the pixels that have about this colour (BGR).
double PartOfColour(const cv::Mat& image, const cv::Scalar& colour);

}  // namespace velamap
