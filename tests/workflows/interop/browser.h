// Pages in headless Chromium, which draws WebGL in software.

#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/workflows/run_velamap.h"

namespace velamap {

// Empty where no Chromium is on the PATH.
std::string FindBrowser();

// Opens the address without a network.
ProgramRun OpenInBrowser(const std::string& browser, const std::string& address,
                         std::vector<std::string> arguments);

// What a page wrote to the console, but for the graphics driver's remarks on taking pictures.
std::vector<std::string> ConsoleLines(const std::string& log);

// Part of the pixels that differ by more than a shade.
double PartThatDiffers(const cv::Mat& a, const cv::Mat& b);

// Part of the pixels that have about this colour (BGR).
double PartOfColour(const cv::Mat& image, const cv::Scalar& colour);

}  // namespace velamap
