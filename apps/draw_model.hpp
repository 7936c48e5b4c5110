// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "apps/draw_graph_frames.hpp"
#include "core/context.hpp"
#include "mcmc/motion_model.hpp"
#include "mcmc/synthesize.hpp"

namespace emberfold::apps {

/// How frames of a model's graphs are drawn: its size, grey where all its levels are, its ground, and the
/// mean of its strokes' sides where a frame has neither.
FrameLook model_look(const mcmc::MotionModel& model, Ground ground, const sketch::FillOptions& fill);

/// What a clip drawn from a model holds.
struct SynthesisFigures {
  std::vector<std::size_t> patches, strokes;  ///< of each frame
  std::array<std::size_t, 6> operators{};     ///< births, deaths, splits, merges, connects, disconnects
  [[nodiscard]] nlohmann::ordered_json json() const;
};

/// Draws `frames` new frames of a model; take(t, frame) gets them in order (CV_8U). A batch at a time; throws
/// Interrupted.
SynthesisFigures draw_model(const mcmc::MotionModel& model, int frames, std::uint64_t seed,
                            const FrameLook& look, const core::Context& context,
                            const std::function<void(int, const cv::Mat&)>& take,
                            mcmc::Start start = mcmc::Start::data);

}  // namespace emberfold::apps
