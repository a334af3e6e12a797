#include "importer/detect/detection_options.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

TEST(ArucoDetectionOptions, CheckNamesTheOption) {
  EXPECT_NO_THROW(ArucoDetectionOptions().Check());
  for (const double rate : {0.0, -1.0, 5.0, std::nan("")}) {
    ArucoDetectionOptions options;
    options.min_marker_perimeter_rate = rate;
    ExpectThrows<InputError>([&] { options.Check(); },
                             {"--ArucoDetection.min_marker_perimeter_rate"});
  }
  ArucoDetectionOptions options;
  options.error_correction_rate = 1.5;
  ExpectThrows<InputError>([&] { options.Check(); }, {"--ArucoDetection.error_correction_rate"});
  options = {};
  options.full_search_interval = 0;
  ExpectThrows<InputError>([&] { options.Check(); }, {"--ArucoDetection.full_search_interval"});
}

}  // namespace
}  // namespace velamap
