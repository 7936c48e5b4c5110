// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::pipeline {

/// Holds an edited model of a clip.
struct EditedClipModel {
  ClipModel model;
  std::vector<std::string> notes;  ///< one line for each change that could not be made in full
};

/// Returns an edited copy of a clip's model: its strokes as mcmc::edit_motion does. An edited model has no
/// footage, which would not show the edit; a neutral edit returns the same model. Throws core::InputError as
/// edit_motion does; core::Cancelled.
EditedClipModel edit_model(ClipModel model, const mcmc::MotionEdit& edit, std::uint64_t seed = 1,
                           const core::Context& context = {});

/// Returns a picture's mean brightness in each cell of a model's grid, fitted to the frame: births for
/// MotionEdit::birth_map. `picture`: CV_8U, CV_16U or CV_32F, one channel, of any size. Throws
/// core::InputError for another format, and for a black picture.
mcmc::CellMap birth_map(const cv::Mat& picture, const mcmc::MotionModel& model);

}  // namespace emberfold::pipeline
