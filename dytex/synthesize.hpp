// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

struct SynthesisOptions {
  std::uint64_t seed = 1;
  /// A training frame, 0 … τ − 1, whose state is x(0). None: x(0) is drawn from the stationary distribution.
  std::optional<int> first_frame;
  bool pixel_noise = false;  ///< adds w(t) to every value
  bool from_mean = false;    ///< x(0) = 0: the clip starts at the mean frame. Not with first_frame
  /// Frames after which the clip begins again, 1 … 10⁶, without a seam: frame `loop` is frame 0 to the byte,
  /// and the step to it a step like any other. States are drawn from the model on a circle of that length
  /// (the noise's v(0) … v(loop − 1) go round) and scaled so that their covariance is the endless clip's. 0:
  /// never. Not with first_frame or from_mean.
  int loop = 0;

  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// An endless clip drawn from a model. Frame t depends on the model, the options and t alone: not on the
/// number of threads, nor on the processor's vector instructions. Frames are made eight at a time, O(m n)
/// each; C is read once for the eight.
class Synthesis {
 public:
  /// `texture` must outlive the synthesis. InputError where it is not valid or the options are not;
  /// NumericalError where a loop cannot be closed.
  Synthesis(const LinearDynamicTexture& texture, const SynthesisOptions& options);
  Synthesis(LinearDynamicTexture&&, const SynthesisOptions&) = delete;

  /// Draws the next frame, in memory of its own: CV_8U, of the texture's size and channels, white = 255.
  cv::Mat next();
  /// Returns the state, N, of the last frame of next(); x(0) before the first.
  [[nodiscard]] const Eigen::VectorXd& state() const { return shown_; }

 private:
  void step();
  void render();

  const LinearDynamicTexture& texture_;
  SynthesisOptions options_;
  std::uint64_t frame_ = 0;  // of state_
  Eigen::VectorXd state_, shown_;
  Eigen::MatrixXd circle_;               // the states of a loop, a column each
  std::vector<Eigen::VectorXd> states_;  // of the frames in ready_
  std::vector<cv::Mat> ready_;
  std::size_t position_ = 0;
};

/// Projects a frame onto the components: Cᵀ (y − mean), n numbers. `levels`: CV_32F of
/// the texture's size and channels, white = 255, else InputError. O(m n).
Eigen::VectorXd project(const LinearDynamicTexture& texture, const cv::Mat& levels);

/// Draws the frame of a state: mean + C diag(weights) x, CV_32F of the texture's size, not clipped. `state`:
/// N numbers, or the n that show; else InputError. O(m n).
cv::Mat draw(const LinearDynamicTexture& texture, const Eigen::Ref<const Eigen::VectorXd>& state);

/// Predicts the frame after `levels`: A times the expected state of its projection, drawn. Throws as
/// project(), expected_state() and draw().
cv::Mat predict(const LinearDynamicTexture& texture, const cv::Mat& levels);

}  // namespace emberfold::dytex
