// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "apps/draw_graph_frames.hpp"
#include "apps/fading.hpp"
#include "apps/residual_texture.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"
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

/// New frames of a model without an end, drawn from its graphs and, where there are any, its grounds. The
/// same frames whatever the number of threads and of calls.
class ModelFrames {
 public:
  /// `between`: called once for each frame, in order, to add a ground or a residual; none: the diffusion.
  using Between = std::function<void(FrameParts&)>;
  ModelFrames(mcmc::Synthesis strokes, FrameLook look, Between between = {});

  /// Draws the next `count` frames, CV_8U, on several threads and hands them to `take`, in order and one at a
  /// time, while the next ones are drawn. At most as many are held as batch() tells. Throws Interrupted.
  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {});
  /// All of them at once.
  std::vector<cv::Mat> next(int count, const core::Context& context = {});
  /// What the next `count` frames are drawn from, instead of them.
  std::vector<FrameParts> parts(int count, const core::Context& context = {});
  /// How many frames are best asked for at once: 16, or as many as 192 MB hold.
  [[nodiscard]] int batch() const;
  /// Of the frames so far.
  [[nodiscard]] const SynthesisFigures& figures() const { return figures_; }
  [[nodiscard]] const FrameLook& look() const { return look_; }

 private:
  struct Drawn {
    graph::AttributeGraph graph;
    std::array<int, 6> operators{};
  };
  Drawn take();
  FrameParts next_parts();

  mcmc::Synthesis strokes_;
  FrameLook look_;
  Between between_;
  SynthesisFigures figures_;
  std::deque<Drawn> ahead_;
  Fader fader_;
};

/// Strokes of a motion model on the ground that a texture of the same clip draws (learn_ground_texture),
/// frame by frame in step; channels as the texture's. core::InputError where the sizes disagree.
ModelFrames hybrid_frames(const mcmc::MotionModel& model,
                          std::shared_ptr<const dytex::LinearDynamicTexture> texture, FrameLook look,
                          std::uint64_t seed, mcmc::Start start = mcmc::Start::data);

/// Strokes of a motion model, what diffuses from them, and the clip's residual on all.
ModelFrames residual_frames(const mcmc::MotionModel& model, const ResidualTexture& residual, FrameLook look,
                            std::uint64_t seed, mcmc::Start start = mcmc::Start::data);

}  // namespace emberfold::apps
