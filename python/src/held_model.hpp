// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "pipeline/clip_model.hpp"

namespace emberfold::python {

/// A model whose numbers can be changed, and what they were before somebody could.
struct HeldModel : pipeline::ClipModel {
  HeldModel() = default;
  explicit HeldModel(pipeline::ClipModel model) : ClipModel(std::move(model)) {}

  std::shared_ptr<const mcmc::MotionModel> learned = {};

  /// Its own footage shows nothing of such a change: strokes are drawn then.
  [[nodiscard]] bool is_changed() const { return learned && *learned != motion; }
  void remember() {
    if (!learned) learned = std::make_shared<const mcmc::MotionModel>(motion);
  }
};

}  // namespace emberfold::python
