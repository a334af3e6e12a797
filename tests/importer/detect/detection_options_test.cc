#include "importer/detect/detection_options.h"

#include <cmath>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

TEST(CornerRefinement, NamesRoundTrip) {
  for (const CornerRefinement refinement :
       {CornerRefinement::kNone, CornerRefinement::kSubpix, CornerRefinement::kEdge}) {
    EXPECT_EQ(CornerRefinementFromName(CornerRefinementName(refinement)), refinement);
  }
  ExpectThrows<InputError>([] { CornerRefinementFromName("magic"); },
                           {"corner_refinement", "'magic'", "none, subpix or edge"});
}

TEST(SearchMode, NamesRoundTrip) {
  for (const SearchMode mode : {SearchMode::kExhaustive, SearchMode::kTracked}) {
    EXPECT_EQ(SearchModeFromName(SearchModeName(mode)), mode);
  }
  ExpectThrows<InputError>([] { SearchModeFromName("fast"); },
                           {"ArucoDetection.search", "'fast'", "tracked or exhaustive"});
}

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
