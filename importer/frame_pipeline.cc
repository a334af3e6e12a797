#include "importer/frame_pipeline.h"

#include <exception>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "importer/base/bounded_queue.h"
#include "importer/base/error.h"
#include "importer/base/parallel.h"

namespace velamap {
namespace {

struct Job {
  int frame_idx = 0;
  Frame frame;
};

struct Done {
  int frame_idx = 0;
  FrameResult result;
};

// Owns the threads and what they share, and joins them however the work ends.
class Pipeline {
 public:
  Pipeline(FrameSource* source, int num_threads,
           const std::function<FrameResult(int, Frame*)>& process)
      : jobs_(static_cast<std::size_t>(num_threads)), source_(source), process_(process) {
    try {
      StartThreads(num_threads);
    } catch (const std::system_error& error) {
      // The threads that have started share the work, if there is one to read and one to process.
      if (threads_.size() >= 2) return;
      End();
      throw InputError(fmt::format(
          "the system cannot start more threads ({}); raise the limit of processes (ulimit -u), or "
          "end other programs",
          error.code().message()));
    }
  }

  ~Pipeline() { End(); }

  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Returns nothing at the end. Throws the first exception of a thread.
  std::optional<Done> NextDone() {
    std::optional<Done> done = done_.Pop();
    if (!done) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (failure_) std::rethrow_exception(failure_);
    }
    return done;
  }

 private:
  void StartThreads(int num_threads) {
    threads_.emplace_back([this] { Run([this] { ReadFrames(); }); });
    for (int i = 0; i < num_threads; ++i) {
      BeginWorker();
      try {
        threads_.emplace_back([this] {
          Run([this] { ProcessFrames(); });
          EndWorker();
        });
      } catch (...) {
        EndWorker();
        throw;
      }
    }
  }

  void BeginWorker() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++num_working_;
  }

  void EndWorker() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--num_working_ == 0) done_.Close();
  }

  void End() {
    jobs_.Abort();
    done_.Abort();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  template <typename Function>
  void Run(const Function& function) {
    try {
      function();
    } catch (...) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
      }
      jobs_.Abort();
      done_.Abort();
    }
  }

  void ReadFrames() {
    for (int frame_idx = 0;; ++frame_idx) {
      std::optional<Frame> frame = source_->Next();
      if (!frame || !jobs_.Push({frame_idx, std::move(*frame)})) break;
    }
    jobs_.Close();
  }

  void ProcessFrames() {
    while (std::optional<Job> job = jobs_.Pop()) {
      Done done{job->frame_idx, process_(job->frame_idx, &job->frame)};
      job.reset();
      if (!done_.Push(std::move(done))) break;
    }
  }

  // One frame waits for each worker, so that no worker stands still while a slow frame is decoded.
  // Each worker holds one more frame, and the reader one.
  BoundedQueue<Job> jobs_;
  // Results hold no pixels, so their number need not be bounded tightly.
  BoundedQueue<Done> done_{1000};
  FrameSource* source_;
  const std::function<FrameResult(int, Frame*)>& process_;
  std::mutex mutex_;
  std::exception_ptr failure_;
  int num_working_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace

void RunFramePipeline(FrameSource* source, int num_threads,
                      const std::function<FrameResult(int, Frame*)>& process,
                      const std::function<void(int, FrameResult)>& consume) {
  VELAMAP_CHECK(num_threads >= 1);
  UseOwnThreadsOnly();
  Pipeline pipeline(source, num_threads, process);
  std::map<int, FrameResult> early;  // processed before a frame that precedes them
  int next_idx = 0;
  while (std::optional<Done> done = pipeline.NextDone()) {
    early.emplace(done->frame_idx, std::move(done->result));
    for (auto it = early.begin(); it != early.end() && it->first == next_idx; ++next_idx) {
      consume(next_idx, std::move(it->second));
      it = early.erase(it);
    }
  }
}

}  // namespace velamap
