// Baseline of velamap's import: OpenCV alone, all frames in one loop on one thread. VideoCapture,
// conversion to grey, detectMarkers with CORNER_REFINE_SUBPIX and the settings that find what
// velamap finds.
//
// usage: plain_detection VIDEO DICTIONARY
// Prints `frames: N` and `markers: M`.

#include <cstdio>
#include <iostream>

#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "importer/detect/detection_options.h"
#include "importer/layout/dictionary.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: plain_detection VIDEO DICTIONARY\n";
    return 2;
  }
  const velamap::ArucoDetectionOptions options;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  parameters->minMarkerPerimeterRate = options.min_marker_perimeter_rate;
  parameters->errorCorrectionRate = options.error_correction_rate;
  const velamap::Dictionary dictionary = velamap::LoadDictionary(argv[2]);
  cv::VideoCapture capture(argv[1], cv::CAP_FFMPEG);
  if (!capture.isOpened()) {
    std::cerr << argv[1] << ": cannot be opened\n";
    return 2;
  }
  int num_frames = 0;
  std::size_t num_markers = 0;
  cv::Mat color, gray;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  while (capture.read(color)) {
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    cv::aruco::detectMarkers(gray, dictionary.aruco, corners, ids, parameters);
    ++num_frames;
    num_markers += ids.size();
  }
  std::printf("frames: %d\nmarkers: %zu\n", num_frames, num_markers);
  return 0;
}
