// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace emberfold::sketch {

/// The element number size / 2 in ascending order of values that are 0 or more, at least one. O(n).
float median(std::vector<float> values);

}  // namespace emberfold::sketch
