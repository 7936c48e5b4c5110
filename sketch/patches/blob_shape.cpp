// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/blob_shape.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::sketch {

BlobShape::BlobShape(const graph::Patch& blob)
    : reach_(std::clamp(blob.width / 2 + 2 * blob.blur, 1.5, 12.0)),
      sd_(std::max(blob.width / 2 + blob.blur, 0.2)),
      cosine_(std::cos(blob.theta)),
      sine_(std::sin(blob.theta)) {}

BlobShape::Shares BlobShape::at(double dx, double dy) const {
  const double bump = std::exp(-0.5 * (dx * dx + dy * dy) / (sd_ * sd_));
  const double right = 0.5 + 0.5 * (dy * cosine_ - dx * sine_) / reach_;
  return {1 - right - 0.5 * bump, bump, right - 0.5 * bump};
}

}  // namespace emberfold::sketch
