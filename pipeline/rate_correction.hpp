// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "mcmc/learning/clip_statistics.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::pipeline {

/// Adds a correction to a motion model's archive, in model.json under "correction".
void add_rate_correction(core::ModelArchive& archive, const RateCorrection& correction);
/// Reads a model's pending correction; nothing where there is none. Throws core::IoError for a damaged one.
std::optional<RateCorrection> read_rate_correction(const core::ModelArchive& archive);

/// Applies the model's pending correction, if any, and removes it. Returns the observed statistics of each
/// round. Throws core::Cancelled. Cost: rounds × at most 150 frames drawn, sketched and matched.
std::vector<mcmc::EventStatistics> correct_rates(ClipModel& model, const core::Context& context = {});

}  // namespace emberfold::pipeline
