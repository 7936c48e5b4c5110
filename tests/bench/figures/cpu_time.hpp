// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <ctime>

namespace emberfold::figures {

/// Milliseconds of this process's CPU time that `work` takes: the least of some repeats.
template <class Work>
double least_time(int repeats, const Work& work) {
  double least = 1e9;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t begin = std::clock();
    work();
    least = std::min(least, 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

}  // namespace emberfold::figures
