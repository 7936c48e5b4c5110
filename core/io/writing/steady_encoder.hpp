// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __linux__
#include <sched.h>
#endif

// The H.264 encoder (x264 164) makes other bytes of the same frames with another number of threads, and it
// reads memory that it never wrote: what was there before decides between choices that are equally good.
// OpenCV 4.6 hands no option on to it. These two make it steady all the same.
namespace emberfold::io {

/// Lets this thread have one processor while it lives: an encoder that starts meanwhile finds one, and takes
/// one thread.
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

/// While one lives, memory that is allocated is filled with zeros. Where the C library is not glibc, nothing
/// happens.
class CleanMemory {
 public:
  CleanMemory();
  ~CleanMemory();
  CleanMemory(const CleanMemory&) = delete;
  CleanMemory& operator=(const CleanMemory&) = delete;
};

}  // namespace emberfold::io
