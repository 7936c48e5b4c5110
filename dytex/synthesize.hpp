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
  /// Where x(0) comes from: drawn from the stationary distribution, or a training frame's state, 0 … τ − 1.
  std::optional<int> first_frame;
  bool pixel_noise = false;  ///< adds w(t) to every value
};

/// An endless clip drawn from a model. Frame t depends on the model, the options and t alone, whatever the
/// number of threads. Frames are made eight at a time, O(m n) each.
class Synthesis {
 public:
  /// `texture` must outlive the synthesis. InputError where it is not valid or first_frame is none of it.
  Synthesis(const LinearDynamicTexture& texture, const SynthesisOptions& options);
  Synthesis(LinearDynamicTexture&&, const SynthesisOptions&) = delete;

  /// The next frame, its own memory: CV_8U, of the texture's size and channels, white = 255.
  cv::Mat next();
  /// The state of the frame that next() gave last, N; of x(0) before the first.
  [[nodiscard]] const Eigen::VectorXd& state() const { return shown_; }

 private:
  void step();
  void render();
  void render_block(const Eigen::MatrixXf& states, std::size_t block);

  const LinearDynamicTexture& texture_;
  SynthesisOptions options_;
  std::uint64_t frame_ = 0;  // of state_
  Eigen::VectorXd state_, shown_;
  std::vector<Eigen::VectorXd> states_;  // of the frames in ready_
  std::vector<cv::Mat> ready_;
  std::size_t position_ = 0;
};

/// Cᵀ (y − mean), n: the states' first numbers that show `levels` best, for weights of 1. `levels`: CV_32F of
/// the texture's size and channels, white = 255, else InputError. O(m n).
Eigen::VectorXd project(const LinearDynamicTexture& texture, const cv::Mat& levels);

/// y = mean + C diag(weights) x: CV_32F of the texture's size and channels, not clipped. `state`: N numbers,
/// or the n that show; else InputError. O(m n).
cv::Mat draw(const LinearDynamicTexture& texture, const Eigen::Ref<const Eigen::VectorXd>& state);

/// The best guess at the frame after `levels`: the projection of `levels`, the rest of the state as it is
/// expected beside it, times A, drawn. As project(), expected_state() and draw().
cv::Mat predict(const LinearDynamicTexture& texture, const cv::Mat& levels);

}  // namespace emberfold::dytex
