// SPDX-License-Identifier: Apache-2.0
// A plain step of EM, value by value, and clips with known dynamics and hidden parts.
#pragma once

#include "dytex/estimation/em.hpp"
#include "tests/dytex/estimation/dense_gaussian.hpp"
#include "tests/support/matrices.hpp"

namespace emberfold::test {

struct PlainStep {
  dytex::StateSpace space;  // B is Q's Cholesky factor
  Look look;
  Eigen::MatrixXd Q, first_covariance;
};

/// The parameters that make everything that the dense Gaussian expects most likely.
PlainStep plain_em_step(const DenseGaussian& known, const Look& look, const Eigen::MatrixXd& Y,
                        const Eigen::MatrixXd& seen, bool noise_per_value, bool with_mean);

/// Rotations that fade, driven by noise, and white noise of variance r on 128; what a linear dynamic texture
/// is.
struct KnownClip {
  Eigen::MatrixXd A, C, states, clean, levels;  // clean: without the white noise
  double r = 0;
};
KnownClip known_clip(Eigen::Index m, Eigen::Index frames, double r, std::uint64_t seed, double strength = 60);

/// A mask clip: 255 where hidden(pixel, frame).
template <class Hidden>
core::Clip mask_clip(int width, int height, Eigen::Index frames, const Hidden& hidden) {
  core::Clip mask{{width, height, 1, CV_8U, 25, 255, frames}, {}};
  for (Eigen::Index t = 0; t < frames; ++t) {
    mask.frames.emplace_back(height, width, CV_8U, cv::Scalar(0));
    for (int p = 0; p < width * height; ++p)
      if (hidden(p, static_cast<int>(t))) mask.frames.back().data[p] = 255;
  }
  return mask;
}

dytex::Missing missing_of(const core::Clip& mask, const core::ClipInfo& info);

}  // namespace emberfold::test
