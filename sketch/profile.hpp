// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/link.hpp"

namespace emberfold::sketch {

/// Fits patches' levels, width, blur and contrast to the image: least squares, the levels in closed form,
/// width and blur over a grid of profiles about the size that the scale tells. Keeps the profiles it has
/// made, so one serves many patches.
class PatchFitter {
 public:
  PatchFitter();
  ~PatchFitter();
  PatchFitter(const PatchFitter&) = delete;
  PatchFitter& operator=(const PatchFitter&) = delete;

  /// Type ridge, valley or step by `kind`; position and theta are kept. The image across the patch is
  /// averaged over `length` px along it. `levels`: CV_32F, 1 or 3 channels; `spread`: px, SD of the profile.
  graph::Patch fit(const cv::Mat& levels, graph::Point position, double theta, CreaseKind kind, double spread,
                   double length);

 private:
  struct Family;
  const Family& family(CreaseKind kind, double spread);
  std::vector<std::unique_ptr<Family>> families_;
};

}  // namespace emberfold::sketch
