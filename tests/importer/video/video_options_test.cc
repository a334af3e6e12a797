#include "importer/video/video_options.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

TEST(VideoOptions, CheckNamesTheOption) {
  EXPECT_NO_THROW(VideoOptions().Check());
  EXPECT_NO_THROW((VideoOptions{5, 5, 1}.Check()));
  ExpectThrows<InputError>([] { VideoOptions{-1, -1, 1}.Check(); }, {"--Video.first_frame"});
  ExpectThrows<InputError>([] { VideoOptions{5, 4, 1}.Check(); }, {"--Video.last_frame"});
  ExpectThrows<InputError>([] { VideoOptions{0, -2, 1}.Check(); }, {"--Video.last_frame"});
  ExpectThrows<InputError>([] { VideoOptions{0, -1, 0}.Check(); }, {"--Video.frame_step"});
}

TEST(VideoOptions, SelectWholeStepsUpToTheLastFrame) {
  const VideoOptions all, some{3, 10, 4};
  for (int number = 0; number < 20; ++number) {
    EXPECT_TRUE(all.Selects(number));
    EXPECT_EQ(some.Selects(number), number == 3 || number == 7) << number;
  }
}

}  // namespace
}  // namespace velamap
