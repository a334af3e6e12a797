// Lets one step run in the order of the frames while all other work on them runs in parallel.

#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>

namespace velamap {

// Holds a value that is passed from frame to frame. The threads must take frames in order, from 0
// and without a gap, as those of frame_pipeline.h do, and create a Turn for every frame.
template <typename Value>
class FrameTurns {
 public:
  // The turn of one frame. The next frame's turn begins when this one ends, even by an exception.
  class Turn {
   public:
    Turn(FrameTurns* turns, int frame_idx) : turns_(turns), frame_idx_(frame_idx) {}
    ~Turn() { End(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

    // Waits until the turns of all earlier frames have ended.
    Value* Wait() {
      std::unique_lock<std::mutex> lock(turns_->mutex_);
      turns_->changed_.wait(lock, [&] { return turns_->next_idx_ == frame_idx_; });
      return &turns_->value_;
    }

    void End() {
      if (has_ended_) return;
      Wait();
      has_ended_ = true;
      const std::lock_guard<std::mutex> lock(turns_->mutex_);
      ++turns_->next_idx_;
      turns_->changed_.notify_all();
    }

   private:
    FrameTurns* turns_;
    int frame_idx_;
    bool has_ended_ = false;
  };

  FrameTurns() = default;
  explicit FrameTurns(Value value) : value_(std::move(value)) {}

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int next_idx_ = 0;
  Value value_;
};

}  // namespace velamap
