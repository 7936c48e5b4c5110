// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a ClipSynthesis.
struct ClipSynthesisOptions {
  std::uint64_t seed = 1;
  std::optional<SynthesisMethod> method = {};  ///< none: the model's footage, or without one the diffusion
  mcmc::Start start = mcmc::Start::data;       ///< the clip's own strokes, or the model's stationary law
  double speed = 1;              ///< speed of the footage, −100…100, not 0; below 0 backwards
  mcmc::MotionEdit edit = {};    ///< of SynthesisMethod::edit and strokes; else edit the model (edit_model)
  std::optional<int> loop = {};  ///< for footage and edit: frames until the clip repeats, ≥ 2
};

/// Holds statistics of a clip drawn from a model.
struct SynthesisStatistics {
  std::vector<std::size_t> patches, strokes;  ///< of each frame
  std::array<std::size_t, 6> operators{};     ///< births, deaths, splits, merges, connects, disconnects
  std::optional<double> copied_share = {};  ///< CopiedShare of every fourth frame; none of a model's strokes
  std::optional<std::size_t> edited = {};   ///< moments in which an edit shows; of the method edit alone

  /// Counts the next frame. `changes`: its numbers of the operators above.
  void add(const graph::AttributeGraph& graph, const std::array<int, 6>& changes) {
    patches.push_back(graph.size());
    strokes.push_back(graph::components(graph).count);
    for (std::size_t k = 0; k < operators.size(); ++k) operators[k] += static_cast<std::size_t>(changes[k]);
  }
};

class FootageSynthesis;
class FrameMethod;

/// Draws an endless number of new frames of a clip's model: CV_8U, with the model's size and rate.
/// Equal models, options and seeds give equal frames, whatever the number of threads and calls. Example:
///
///     pipeline::ClipSynthesis synthesis(model, {.seed = 7});
///     io::write_video("new.mp4", synthesis, 300);
class ClipSynthesis final : public core::FrameSource {
 public:
  /// Keeps a copy of the model. Throws core::InputError where it lacks the part that options.method needs;
  /// core::Cancelled.
  explicit ClipSynthesis(ClipModel model, const ClipSynthesisOptions& options = {},
                         const core::Context& context = {});
  ~ClipSynthesis() override;
  ClipSynthesis(ClipSynthesis&&) noexcept;
  ClipSynthesis& operator=(ClipSynthesis&&) noexcept;

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  /// Returns the next frame; several are drawn at once, ahead of it. Throws core::Cancelled.
  cv::Mat next() override;
  /// Starts again from the first frame.
  void rewind() override;
  /// Draws the next `count` frames on several threads and hands them to `take`.
  /// They are handed over in order and one at a time, while the next ones are drawn. Throws core::Cancelled.
  void each(int count, const std::function<void(cv::Mat)>& take);
  /// Returns statistics of the strokes drawn so far, those ahead of next() included; null for footage and
  /// texture.
  [[nodiscard]] const SynthesisStatistics* statistics() const;
  /// Returns the graphs of the clip's first `count` ≥ 1 frames with their links. Throws core::InputError for
  /// footage and texture, which draw no strokes; core::Cancelled.
  [[nodiscard]] graph::MotionGraph motion(int count) const;
  /// Returns the synthesis of the footage; null for other methods.
  [[nodiscard]] const FootageSynthesis* footage() const;
  /// Returns how frames are made.
  [[nodiscard]] SynthesisMethod method() const { return method_; }

 private:
  std::shared_ptr<const ClipModel> model_;
  ClipSynthesisOptions options_;
  core::Context context_;
  core::ClipInfo info_;
  SynthesisMethod method_ = SynthesisMethod::diffusion;
  std::unique_ptr<FrameMethod> frames_;
  std::deque<cv::Mat> ahead_;
};

}  // namespace emberfold::pipeline
