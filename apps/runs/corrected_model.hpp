// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/context.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::apps {

/// Makes the correction of rates that a model waits for (pipeline::correct_rates), once on this machine: the
/// rates are kept in emberfold/corrected below $XDG_CACHE_HOME, or ~/.cache, by a hash of the model, and read
/// there the next time. The model's folder stays as it is. Where nothing can be kept it is made each time.
/// Throws core::Cancelled.
void correct_rates_once(pipeline::ClipModel& model, const core::Context& context);

}  // namespace emberfold::apps
