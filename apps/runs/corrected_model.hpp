// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/context.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::apps {

/// Applies a model's pending correction of rates (pipeline::correct_rates), once per machine.
/// The rates are cached in emberfold/corrected below $XDG_CACHE_HOME, or ~/.cache, by a hash of the model,
/// and read from there later. The model's folder stays unchanged. Where nothing can be cached, they are
/// computed each time. Throws core::Cancelled.
void correct_rates_once(pipeline::ClipModel& model, const core::Context& context);

}  // namespace emberfold::apps
