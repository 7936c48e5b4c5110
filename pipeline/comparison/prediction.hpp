// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::pipeline {

struct ComparedModel;

/// Holds the agreement of predicted or reconstructed frames with the true ones.
struct FrameQuality {
  double psnr = 0;  ///< dB, of the mean square error over all frames, pixels and channels; at most 100
  double ssim = 0;  ///< of luma, mean over frames

  bool operator==(const FrameQuality&) const = default;
};

/// Holds the quality of one method's predictions.
struct MethodPrediction {
  std::string key;                                   ///< a model's key, "frame_before" or "mean_image"
  std::vector<std::optional<FrameQuality>> by_step;  ///< none where the clip has no such frame
  std::vector<double> next_frame_psnr;               ///< dB, one step ahead, by start
  std::optional<FrameQuality> reconstruction;        ///< of a given frame
};

/// Holds the quality of predictions of frames from those before them.
struct PredictionMeasures {
  int first_frame = 0;     ///< the first predicted frame
  int starts = 0;          ///< frames that were predicted from
  std::vector<int> steps;  ///< frames ahead, ascending
  std::vector<MethodPrediction> methods;
};

/// Returns 1, 2, 4 …, and `most` itself.
std::vector<int> prediction_steps(int most);

/// Measures the predictions of frames first … frames − 1, and the reconstruction of given frames.
/// From at most 32 starts, evenly spread, every model predicts all steps, and so do two methods without a
/// model: repeating the frame before ("frame_before"), and the mean image of the frames before `first`
/// ("mean_image"). Frames are rounded to 8 bits and compared. Holds a batch of frames. Throws
/// core::Cancelled.
PredictionMeasures measure_prediction(core::FrameSource& source, int first, int frames,
                                      std::span<const int> steps, std::span<const ComparedModel> models,
                                      const core::Context& context);

}  // namespace emberfold::pipeline
