#include "importer/frame_turns.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/frame_pipeline.h"

namespace velamap {
namespace {

class TurnSource : public FrameSource {
 public:
  std::optional<Frame> Next() override {
    return num_read_++ < 200 ? std::optional<Frame>(Frame()) : std::nullopt;
  }
  bool Load(Frame*, std::string*) const override { return true; }
  bool IsVideo() const override { return true; }
  int NumFrames() const override { return 200; }

 private:
  int num_read_ = 0;
};

TEST(FrameTurns, TurnsComeInOrderWhateverHappensToAFrame) {
  for (const bool fails : {false, true}) {
    FrameTurns<std::vector<int>> turns;
    std::vector<int> order;
    TurnSource source;
    const auto run = [&] {
      RunFramePipeline(
          &source, 4,
          [&](int frame_idx, Frame*) {
            FrameTurns<std::vector<int>>::Turn turn(&turns, frame_idx);
            if (frame_idx % 7 == 3) return FrameResult();  // a frame that is skipped
            if (fails && frame_idx == 50) throw InputError("bad");
            turn.Wait()->push_back(frame_idx);
            order = *turn.Wait();
            return FrameResult();
          },
          [](int, const FrameResult&) {});
    };
    if (fails) {
      EXPECT_THROW(run(), InputError);
    } else {
      run();
      EXPECT_EQ(order.size(), 171u);
    }
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  }
}

}  // namespace
}  // namespace velamap
