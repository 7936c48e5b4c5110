// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace emberfold::core {

/// The weights of blue, green and red in luma (ITU-R BT.601).
constexpr std::array<double, 3> kLumaWeights = {0.114, 0.587, 0.299};

/// Returns the luma of a colour given in OpenCV's order.
constexpr double luma(double blue, double green, double red) {
  return kLumaWeights[0] * blue + kLumaWeights[1] * green + kLumaWeights[2] * red;
}

}  // namespace emberfold::core
