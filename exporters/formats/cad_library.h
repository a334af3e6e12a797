// What the CAD writer and reader share: Open CASCADE's global state, kept in hand.

#pragma once

#include <mutex>

namespace velamap {

// While it lives: no other thread is in Open CASCADE's data exchange, and its messages go nowhere
// (they would go to stdout). Sets up both formats the first time.
class CadSession {
 public:
  CadSession();
  CadSession(const CadSession&) = delete;
  CadSession& operator=(const CadSession&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace velamap
