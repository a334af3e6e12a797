// Linked into the test programs of sanitizer builds: OpenCV starts no threads there, as in velamap
// itself. The thread sanitizer cannot see what orders the threads of a library that was built
// without it.

#include "importer/base/parallel.h"

namespace {

const struct OwnThreadsOnly {
  OwnThreadsOnly() { velamap::UseOwnThreadsOnly(); }
} own_threads_only;

}  // namespace
