// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/sketching/sketch_frames.hpp"
#include "core/context.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::apps {

/// Returns `count` (≥ 2) numbers of steps from 0 to `last` (≥ 1) in geometric progression, rounded to
/// different whole numbers; fewer where `last` is below count − 1.
std::vector<std::int64_t> heat_steps(std::int64_t last, int count);

/// Estimates the number of explicit steps after which the diffusion is nearly at rest.
std::int64_t steps_to_rest(const cv::Mat& mask);

/// The diffusion at one time.
struct HeatMoment {
  cv::Mat levels;  ///< CV_32F
  std::int64_t steps = 0;
  double time = 0;       ///< px²
  bool at_rest = false;  ///< levels are the fill itself
};

/// Bounds of run_heat().
struct HeatOptions {
  int moments = 96;         ///< approximate number, ≥ 3
  double most_work = 4e11;  ///< approximate limit of computed values
};

/// Diffuses from the sketchable part on mid-grey, or from `empty` where there is none, by explicit steps.
/// Calls take() at times in geometric progression until all levels are within half a grey level of the fill,
/// and last with the fill itself. Returns false where `most_work` stopped it earlier. Throws core::Cancelled.
bool run_heat(const sketch::Sketchable& held, const cv::Scalar& empty, const HeatOptions& options,
              const core::Context& context, const std::function<void(const HeatMoment&)>& take);

/// Reads the request's frame again and writes heat.mp4.
void write_heat_film(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                     io::OutputFolder& output, Session& session);

}  // namespace emberfold::apps
