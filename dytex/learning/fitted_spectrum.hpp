// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/clip.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/model_order.hpp"

namespace emberfold::dytex::detail {

/// The part of a model that depends on the frames' spectrum alone: all but its mean and C.
struct FittedSpectrum {
  LearnResult result;       ///< `texture.C` has n columns and no rows, `texture.mean` is empty
  Eigen::MatrixXd weights;  ///< τ × n, V S⁻¹: centred frames times it are C
  bool single = true;       ///< single precision is enough for C
};

/// Throws InputError where `components` are set by number and a clip of this number of frames has fewer.
void check_count(const LearnOptions& options, Eigen::Index frames);

/// Chooses the components by the options and fits their motion. `gram`: the raw matrix that the spectrum is
/// of, which Order::held_out reads; `info` gives the number of frames.
FittedSpectrum fit_spectrum(const Spectrum& spectrum, const Eigen::MatrixXd& gram, const core::ClipInfo& info,
                            const LearnOptions& options);

}  // namespace emberfold::dytex::detail
