// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"

namespace emberfold::mcmc {

/// Defines what the images say of patches; the posterior takes a share of it (weigh_candidates).
class Evidence {
 public:
  virtual ~Evidence() = default;
  /// Returns the gain in coding length, nats, of drawing `patch` rather than filling its place.
  /// Negative where the image does not support the patch. Safe to call from several threads.
  [[nodiscard]] virtual double gain(int frame, const graph::Patch& patch) const = 0;
};

/// Takes the gains that the sketch stored in its patches (graph::Patch::gain); needs no image.
class SketchEvidence final : public Evidence {
 public:
  [[nodiscard]] double gain(int /*frame*/, const graph::Patch& patch) const override { return patch.gain; }
};

}  // namespace emberfold::mcmc
