// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/io/frame_decoders.hpp"

namespace emberfold::io {

/// Range of the finite values of a clip.
struct ValueRange {
  double min = 0, max = 0;
  double low = 0, high = 0;  ///< percentiles 0.1 and 99.9
  std::int64_t count = 0;    ///< of finite values
  std::int64_t missing = 0;  ///< non-finite values
};

/// Measures the range of all values of a clip of 16 bits or floats. Reads it whole, and rewinds it.
ValueRange measure_range(FrameDecoder& clip);

/// Smallest and largest value that three pixels in a row reach.
struct SharedRange {
  double min = 0, max = 0;
  bool exists = false;  ///< false where frames are smaller than three pixels
};

/// Measures the range without isolated pixels (hot, dead, hit by a particle); lines one pixel wide count.
/// Reads the clip whole, and rewinds it. Cost: eight filters of three pixels a frame.
SharedRange measure_shared_range(FrameDecoder& clip);

}  // namespace emberfold::io
