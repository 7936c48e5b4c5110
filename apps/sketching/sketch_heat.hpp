// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/sketching/sketch_frames.hpp"
#include "core/context.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::apps {

/// `count` (≥ 2) numbers of steps from 0 to `last` (≥ 1), each as many times the one before as the next,
/// as far as whole numbers allow; fewer where `last` is below count − 1.
std::vector<std::int64_t> heat_steps(std::int64_t last, int count);

/// A number of explicit steps after which the diffusion is about at rest.
std::int64_t steps_to_rest(const cv::Mat& mask);

/// A moment of the diffusion.
struct HeatMoment {
  cv::Mat levels;  ///< CV_32F
  std::int64_t steps = 0;
  double time = 0;       ///< px²
  bool at_rest = false;  ///< the fill itself
};

struct HeatOptions {
  int moments = 96;         ///< about so many, ≥ 3
  double most_work = 4e11;  ///< values computed, at most about so many
};

/// The diffusion from what is held on mid-grey (of a frame where nothing is held, from its mean, `empty`) to
/// rest, by explicit steps: take() is called with moments in geometric spacing, until none of the levels is
/// half a grey level from the fill's, and in the end with the fill itself. Returns whether it came that near;
/// false where it ended for `most_work`. Throws core::Cancelled.
bool run_heat(const sketch::Sketchable& held, const cv::Scalar& empty, const sketch::FillOptions& fill,
              const HeatOptions& options, const core::Context& context,
              const std::function<void(const HeatMoment&)>& take);

/// Writes heat.mp4 of the request's frame, which is read and drawn again.
void write_heat_film(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                     io::OutputFolder& output, Session& session);

}  // namespace emberfold::apps
