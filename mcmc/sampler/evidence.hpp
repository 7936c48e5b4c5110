// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"

namespace emberfold::mcmc {

/// All that the posterior sees of the images: log p(I | G) is the sum over patches of what each saves.
class Evidence {
 public:
  virtual ~Evidence() = default;
  /// The gain in coding length, nats, of showing `patch` in frame `frame` rather than leaving its place to
  /// the fill; negative where the image does not bear it out. Safe to call from several threads.
  [[nodiscard]] virtual double gain(int frame, const graph::Patch& patch) const = 0;
};

/// What the sketch noted of its patches as it made them (graph::Patch::gain): needs no image.
class SketchEvidence final : public Evidence {
 public:
  [[nodiscard]] double gain(int /*frame*/, const graph::Patch& patch) const override { return patch.gain; }
};

}  // namespace emberfold::mcmc
