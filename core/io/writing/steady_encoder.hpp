// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __linux__
#include <sched.h>
#endif

// The H.264 encoder (x264 164) makes other bytes of the same frames with another number of threads, and it
// reads memory that it never wrote, whose content then decides between equally good choices. OpenCV 4.6
// passes no option to it. These two classes make its output reproducible.
namespace emberfold::io {

/// Restricts this thread to one processor during its lifetime: an encoder started meanwhile finds one, and
/// uses one thread.
class OneProcessor {
 public:
  OneProcessor();
  ~OneProcessor();
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
#ifdef __linux__
  cpu_set_t before_ = {};
#endif
  bool changed_ = false;
};

/// Fills allocated memory with zeros while one exists. Does nothing where the C library is not glibc.
class CleanMemory {
 public:
  CleanMemory();
  ~CleanMemory();
  CleanMemory(const CleanMemory&) = delete;
  CleanMemory& operator=(const CleanMemory&) = delete;
};

}  // namespace emberfold::io
