#include "importer/frame_pipeline.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

#include "importer/base/bounded_queue.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr uid_t kUserWithoutProcesses = 64123;

// Counts the frames that have been read and not yet processed.
class FakeSource : public FrameSource {
 public:
  explicit FakeSource(int num_frames) : num_frames_(num_frames) {}

  std::optional<Frame> Next() override {
    if (num_read == num_frames_) return std::nullopt;
    max_in_flight = std::max(max_in_flight, num_read + 1 - num_processed);
    Frame frame;
    frame.image_name = std::to_string(num_read++);
    return frame;
  }
  bool Load(Frame*, std::string*) const override { return true; }
  bool IsVideo() const override { return false; }
  int NumFrames() const override { return num_frames_; }

  int num_read = 0;
  std::atomic<int> num_processed{0};
  int max_in_flight = 0;

 private:
  int num_frames_;
};

void SleepUnevenly(int frame_idx) {
  std::this_thread::sleep_for(std::chrono::microseconds(37 * frame_idx % 500));
}

TEST(RunFramePipeline, ResultsComeInOrderAndFewFramesAreInFlight) {
  for (const int num_threads : {1, 4}) {
    FakeSource source(200);
    std::vector<std::string> names;
    RunFramePipeline(
        &source, num_threads,
        [&](int frame_idx, Frame* frame) {
          SleepUnevenly(frame_idx);
          FrameResult result;
          result.detections.image_name = frame->image_name;
          ++source.num_processed;
          return result;
        },
        [&](int frame_idx, const FrameResult& result) {
          EXPECT_EQ(result.detections.image_name, std::to_string(frame_idx));
          names.push_back(result.detections.image_name);
        });
    EXPECT_EQ(names.size(), 200u);
    EXPECT_LE(source.max_in_flight, 2 * num_threads + 1);
  }
}

TEST(RunFramePipeline, FailuresOnAnySideEndItAndAreHandedOn) {
  const auto pass = [](int, Frame*) { return FrameResult(); };
  FakeSource a(100000);
  EXPECT_THROW(RunFramePipeline(
                   &a, 3,
                   [&](int frame_idx, Frame*) {
                     if (frame_idx == 20) throw InputError("bad");
                     return FrameResult();
                   },
                   [](int, const FrameResult&) {}),
               InputError);
  EXPECT_LT(a.num_read, 100000);
  FakeSource b(100000);
  EXPECT_THROW(RunFramePipeline(&b, 3, pass,
                                [](int frame_idx, const FrameResult&) {
                                  if (frame_idx == 20) throw DataError("bad");
                                }),
               DataError);
  EXPECT_LT(b.num_read, 100000);
}

// Runs the pipeline as a user who may have `max_num_threads` threads, and ends the process with 0
// if all frames came out, or with 101 after an input error. For a child process.
void RunWithFewThreads(unsigned max_num_threads) {
  const rlimit limit{max_num_threads, max_num_threads};
  // A user for each process, because the threads of one that has just ended may still count.
  const uid_t user = kUserWithoutProcesses + static_cast<uid_t>(getpid()) % 100000;
  if (setrlimit(RLIMIT_NPROC, &limit) != 0 || setuid(user) != 0) std::_Exit(102);
  // More than can wait, so that the reading thread does not end before the others start.
  constexpr int kNumFrames = 2000;
  FakeSource source(kNumFrames);
  int num_frames = 0;
  try {
    RunFramePipeline(
        &source, 64, [](int, Frame*) { return FrameResult(); },
        [&](int, const FrameResult&) { ++num_frames; });
  } catch (const InputError&) {
    std::_Exit(101);
  }
  std::_Exit(num_frames == kNumFrames ? 0 : 103);
}

TEST(RunFramePipeline, TakesTheThreadsThatTheSystemGives) {
  // Only the superuser can become a user whose processes are known.
  if (geteuid() != 0) GTEST_SKIP() << "needs the rights to change the user";
  EXPECT_EXIT(RunWithFewThreads(6), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(RunWithFewThreads(3), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(RunWithFewThreads(2), testing::ExitedWithCode(101), "");
  EXPECT_EXIT(RunWithFewThreads(1), testing::ExitedWithCode(101), "");
}

TEST(BoundedQueue, ClosedQueueHandsOutWhatIsLeft) {
  BoundedQueue<int> queue(3);
  EXPECT_TRUE(queue.Push(1));
  EXPECT_TRUE(queue.Push(2));
  queue.Close();
  EXPECT_FALSE(queue.Push(3));
  EXPECT_EQ(queue.Pop(), 1);
  EXPECT_EQ(queue.Pop(), 2);
  EXPECT_EQ(queue.Pop(), std::nullopt);
}

TEST(BoundedQueue, AbortDropsEverythingAndWakesWaiters) {
  BoundedQueue<int> queue(1);
  EXPECT_TRUE(queue.Push(1));
  std::thread waiter([&] { EXPECT_FALSE(queue.Push(2)); });
  queue.Abort();
  waiter.join();
  EXPECT_EQ(queue.Pop(), std::nullopt);
}

}  // namespace
}  // namespace velamap
