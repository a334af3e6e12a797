#include "importer/video/written_frame.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace {
std::atomic<int> num_syncs{0};
}

// Take the place of the C library's functions in this program and count their calls.
extern "C" int fsync(int file) {
  ++num_syncs;
  return static_cast<int>(syscall(SYS_fsync, file));
}

extern "C" int syncfs(int file) noexcept {
  ++num_syncs;
  return static_cast<int>(syscall(SYS_syncfs, file));
}

namespace velamap {
namespace {

namespace fs = std::filesystem;

Frame GrayFrame() {
  Frame frame;
  frame.color = cv::Mat(20, 30, CV_8UC3, cv::Scalar(90, 90, 90));
  return frame;
}

TEST(WriteFrameImage, ManyFramesWaitForTheDiskOnce) {
  const TempDir dir;
  num_syncs = 0;
  for (int i = 0; i < 5; ++i) {
    WriteFrameImage(GrayFrame(), dir / ("frames/" + std::to_string(i) + ".jpg"));
  }
  EXPECT_EQ(num_syncs, 0);
  SyncFileSystem(dir / "frames");
  EXPECT_EQ(num_syncs, 1);
  WriteFileAtomically(dir / "shape.csv", [](std::ostream&) {});
  EXPECT_EQ(num_syncs, 2);
  EXPECT_EQ(cv::imread(dir / "frames/4.jpg").size(), cv::Size(30, 20));
}

TEST(WriteFrameImage, FailureLeavesNoFile) {
  const TempDir dir;
  fs::create_directory(dir / "0.jpg");
  ExpectThrows<InputError>([&] { WriteFrameImage(GrayFrame(), dir / "0.jpg"); }, {dir / "0.jpg"});
  EXPECT_EQ(std::distance(fs::directory_iterator(dir.path()), {}), 1);
  ExpectThrows<InputError>([&] { SyncFileSystem(dir / "none"); }, {dir / "none"});
}

}  // namespace
}  // namespace velamap
