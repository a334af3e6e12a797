#include "reconstruct/adjust/found_cameras.h"

#include <gmock/gmock.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

TEST(FoundCameras, AFocalLengthOfMoreThanFivePercentSigmaIsRefused) {
  const Camera camera{CameraModel::kSimpleRadial, 1920, 1080, {1000, 960, 540, 0}};
  EXPECT_NO_THROW(CheckFocalLength({{1, {camera, {49, 1, 1, 0}}}}, ""));
  EXPECT_THROW(CheckFocalLength({{1, {camera, {51, 1, 1, 0}}}}, ""), DataError);
}

TEST(FoundCameras, AnInsetIsInTheSigmasOfAllFocalLengthsAndNoOthers) {
  const Camera camera{CameraModel::kOpenCV, 1920, 1080, {1000, 2000, 960, 540, 0.1, 0, 0, 0}};
  std::vector<double> sigmas = {3, 0, 1, 1, 0.1, 0.1, 0.1, 0.1};
  AddInset(0.004, camera, &sigmas);
  EXPECT_THAT(sigmas, testing::ElementsAre(5, 8, 1, 1, 0.1, 0.1, 0.1, 0.1));
}

}  // namespace
}  // namespace velamap
