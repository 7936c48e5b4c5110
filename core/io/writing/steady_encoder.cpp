// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/steady_encoder.hpp"

#include <mutex>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace emberfold::io {

#ifdef __linux__

OneProcessor::OneProcessor() {
  if (::sched_getaffinity(0, sizeof before_, &before_) != 0) return;
  int first = 0;
  while (first < CPU_SETSIZE && !CPU_ISSET(first, &before_)) ++first;
  if (first == CPU_SETSIZE) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  changed_ = ::sched_setaffinity(0, sizeof one, &one) == 0;
}

OneProcessor::~OneProcessor() {
  if (changed_) ::sched_setaffinity(0, sizeof before_, &before_);
}

#else

OneProcessor::OneProcessor() = default;
OneProcessor::~OneProcessor() = default;

#endif

#ifdef __GLIBC__

namespace {

std::mutex mutex;
int living = 0;  // several writers may be at work

/// Fills memory that glibc takes back with this, and what it allocates with the complement; 0: neither.
void fill_memory(int change, int byte) {
  const std::lock_guard lock(mutex);
  const bool was = living > 0;
  living += change;
  if (was != (living > 0)) ::mallopt(M_PERTURB, byte);  // NOLINT(concurrency-mt-unsafe): under the lock
}

}  // namespace

CleanMemory::CleanMemory() {
  fill_memory(1, 0xFF);
}

CleanMemory::~CleanMemory() {
  fill_memory(-1, 0);
}

#else

CleanMemory::CleanMemory() = default;
CleanMemory::~CleanMemory() = default;

#endif

}  // namespace emberfold::io
