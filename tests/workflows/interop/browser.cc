#include "tests/workflows/interop/browser.h"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include <opencv2/imgproc.hpp>

#include "tests/support/temp_dir.h"

namespace velamap {

namespace fs = std::filesystem;

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

ProgramRun OpenInBrowser(const std::string& browser, const std::string& address,
                         std::vector<std::string> arguments) {
  const TempDir profile;
  arguments.insert(
      arguments.end(),
      {"--headless", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
       "--no-first-run", "--hide-scrollbars", "--enable-logging=stderr",
       "--user-data-dir=" + profile.path().string(), "--host-resolver-rules=MAP * ~NOTFOUND"});
  if (geteuid() == 0) arguments.push_back("--no-sandbox");  // refuses to start otherwise
  arguments.push_back(address);
  return RunProgram(browser, arguments);
}

}  // namespace velamap
