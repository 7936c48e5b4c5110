// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::pipeline {

/// Predicts frames from the newest ones of a clip.
/// A prediction is a weighted sum, with weights learned by place, of the newest frame moved along its motion,
/// that smoothed, the frame itself, and the one before, each less the mean image.
struct CarriedPrediction {
  std::vector<int> steps;        ///< frames ahead that can be predicted, ascending
  cv::Mat mean;                  ///< CV_32F, levels
  std::vector<cv::Mat> weights;  ///< by step: CV_32FC4, one vector per cell of 16 px

  /// Returns the number of parameters.
  [[nodiscard]] double parameters() const;
};

/// Learns the weights by least squares from at most 24 starts in a clip, regularised towards those of the
/// whole frame. Reads the clip twice and holds the greatest step's number of frames. Throws core::InputError
/// for a clip with no frame to predict, core::Cancelled.
CarriedPrediction learn_carried_prediction(core::FrameSource& source, std::span<const int> steps,
                                           const core::Context& context);

/// Predicts frames from the newest ones, `past`: levels (CV_32F), at least two. Each of `steps` must be in
/// model.steps.
std::vector<cv::Mat> predict(const CarriedPrediction& model, std::span<const cv::Mat> past,
                             std::span<const int> steps);

}  // namespace emberfold::pipeline
