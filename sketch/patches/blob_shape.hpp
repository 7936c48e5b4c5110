// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Computes which share of each of its levels a blob shows at a pixel (graph::Patch).
class BlobShape {
 public:
  explicit BlobShape(const graph::Patch& blob);

  [[nodiscard]] double reach() const { return reach_; }  ///< px, radius of the disc
  /// Returns whether the disc holds the pixel at this offset from the blob's position, px.
  [[nodiscard]] bool holds(double dx, double dy) const { return dx * dx + dy * dy <= reach_ * reach_ + 1e-6; }
  /// Shares of left, middle and right; they add up to 1.
  struct Shares {
    double left, middle, right;
  };
  [[nodiscard]] Shares at(double dx, double dy) const;

 private:
  double reach_, sd_, cosine_, sine_;
};

}  // namespace emberfold::sketch
