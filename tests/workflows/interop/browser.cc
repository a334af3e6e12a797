#include "tests/workflows/interop/browser.h"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>
#include <utility>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Empty where no Chromium is on the PATH.
std::string FindBrowser() {
  std::istringstream folders(getenv("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      const fs::path path = fs::path(folder) / name;
      if (fs::exists(path)) return path.string();
    }
  }
  return {};
}

// What a page wrote to the console, but for the graphics driver's remarks on taking pictures.
std::vector<std::string> ConsoleLines(const std::string& log) {
  std::vector<std::string> lines;
  std::istringstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    if (line.find("CONSOLE") != std::string::npos &&
        line.find("GL Driver Message (OpenGL, Performance") == std::string::npos) {
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace

TempDir* BrowserTest::dir_ = nullptr;

void BrowserTest::SetUp() {
  browser_ = FindBrowser();
  if (browser_.empty()) GTEST_SKIP() << "chromium is not on the PATH";
}

ProgramRun BrowserTest::Open(const std::string& page, std::vector<std::string> arguments) const {
  const TempDir profile;
  arguments.insert(
      arguments.end(),
      {"--headless", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
       "--no-first-run", "--hide-scrollbars", "--enable-logging=stderr",
       "--user-data-dir=" + profile.path().string(), "--host-resolver-rules=MAP * ~NOTFOUND"});
  if (geteuid() == 0) arguments.push_back("--no-sandbox");  // refuses to start otherwise
  arguments.push_back("file://" + dir_->path().string() + "/" + page);
  const ProgramRun run = RunProgram(browser_, arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(ConsoleLines(run.err), testing::ElementsAre());
  return run;
}

cv::Mat BrowserTest::Screenshot(const std::string& page, int width, int height,
                                const std::string& name, std::vector<std::string> more) const {
  fs::create_directories(VELAMAP_PICTURE_DIR);
  const std::string path = std::string(VELAMAP_PICTURE_DIR) + "/" + name;
  fs::remove(path);
  more.push_back("--screenshot=" + path);
  more.push_back("--window-size=" + std::to_string(width) + "," + std::to_string(height));
  Open(page, std::move(more));
  const cv::Mat picture = cv::imread(path);
  EXPECT_EQ(picture.cols, width) << path;
  return picture;
}

std::string EscapedForAttribute(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

double PartThatDiffers(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  cv::Mat channels[3];
  cv::split(difference, channels);
  const cv::Mat most = cv::max(channels[0], cv::max(channels[1], channels[2]));
  return cv::countNonZero(most > 24) / static_cast<double>(most.total());
}

double PartOfColour(const cv::Mat& image, const cv::Scalar& colour) {
  cv::Mat mask;
  cv::inRange(image, colour - cv::Scalar::all(12), colour + cv::Scalar::all(12), mask);
  return cv::countNonZero(mask) / static_cast<double>(mask.total());
}

}  // namespace velamap
