// Access to the global state of Open CASCADE for the CAD writer and reader.

#pragma once

#include <mutex>

namespace velamap {

// Locks Open CASCADE's data exchange for other threads and silences its messages, which would go to
// stdout. The first session initializes both formats.
class CadSession {
 public:
  CadSession();
  CadSession(const CadSession&) = delete;
  CadSession& operator=(const CadSession&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace velamap
