// SPDX-License-Identifier: Apache-2.0
#include "tests/support/matrices.hpp"

#include <cmath>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "tests/support/reference_linalg.hpp"

namespace emberfold::test {

Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  core::Rng rng(seed);
  Eigen::MatrixXd result(rows, columns);
  for (double& x : result.reshaped()) x = rng.normal();
  return result;
}

Eigen::MatrixXd orthonormal(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  return orthonormal_columns(normals(rows, columns, seed));
}

core::Clip clip_of(const Eigen::MatrixXd& levels, int width, int height, int channels, int depth) {
  const double white = depth == CV_8U ? 255 : depth == CV_16U ? 65535 : 1;
  core::Clip clip{{width, height, channels, depth, 25, white, levels.cols()}, {}};
  for (Eigen::Index t = 0; t < levels.cols(); ++t) {
    const Eigen::VectorXd column = levels.col(t);
    const cv::Mat frame(height, width, CV_MAKETYPE(CV_64F, channels), const_cast<double*>(column.data()));
    clip.frames.emplace_back();
    frame.convertTo(clip.frames.back(), depth, white / 255);
  }
  return clip;
}

Eigen::MatrixXd levels_of(const core::Clip& clip) {
  Eigen::MatrixXd result(clip.info.width * clip.info.height * clip.info.channels,
                         static_cast<Eigen::Index>(clip.frames.size()));
  for (std::size_t t = 0; t < clip.frames.size(); ++t) {
    cv::Mat levels;
    clip.frames[t].convertTo(levels, CV_64F, 255 / clip.info.white);
    result.col(static_cast<Eigen::Index>(t)) =
        Eigen::Map<const Eigen::VectorXd>(levels.ptr<double>(), result.rows());
  }
  return result;
}

core::Clip wavy_clip(int width, int height, int channels, int depth, int frames, std::uint64_t seed) {
  const Eigen::Index m = Eigen::Index{width} * height * channels;
  const Eigen::MatrixXd shapes = normals(m, 6, seed), grain = normals(m, frames, seed + 1);
  Eigen::MatrixXd levels(m, frames);
  for (int t = 0; t < frames; ++t) {
    Eigen::VectorXd weights(6);
    for (int k = 0; k < 3; ++k) {
      weights[2 * k] = 12 / (1.0 + k) * std::cos(0.3 * (k + 1) * t);
      weights[2 * k + 1] = 12 / (1.0 + k) * std::sin(0.3 * (k + 1) * t);
    }
    levels.col(t) = (shapes * weights + 3 * grain.col(t)).array() + 128;
  }
  return clip_of(levels, width, height, channels, depth);
}

core::Clip flaring_clip(double grain) {
  Eigen::MatrixXd levels(48, 40);
  const Eigen::MatrixXd shapes = orthonormal(48, 2, 9), noise = normals(48, 40, 10);
  for (int t = 0; t < 40; ++t)
    levels.col(t) = (40 * std::pow(1.05, t) * shapes.col(0) + 30 * std::cos(0.7 * t) * shapes.col(1) +
                     grain * noise.col(t))
                        .array() +
                    100;
  return clip_of(levels, 8, 6, 1, CV_32F);
}

PrincipalAxes principal_axes(const Eigen::MatrixXd& states) {
  const Eigen::MatrixXd centred = states.colwise() - states.rowwise().mean();
  const ThinSvd svd = thin_svd(centred);
  return {{svd.s, svd.V}, svd.U.transpose()};
}

std::vector<cv::Mat> drawn_frames(const dytex::LinearDynamicTexture& texture,
                                  const dytex::SynthesisOptions& options, int count) {
  dytex::Synthesis synthesis(texture, options);
  std::vector<cv::Mat> result;
  for (int t = 0; t < count; ++t) result.push_back(synthesis.next());
  return result;
}

bool same(const dytex::LinearDynamicTexture& a, const dytex::LinearDynamicTexture& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.rows() == y.rows() && x.cols() == y.cols() && (x.array() == y.array()).all();
  };
  return a.info == b.info && a.r == b.r && equal(a.mean, b.mean) && equal(a.C, b.C) && equal(a.A, b.A) &&
         equal(a.B, b.B) && equal(a.states, b.states) && equal(a.singular, b.singular) &&
         equal(a.weights, b.weights) && equal(a.noise, b.noise) && a.noise_share == b.noise_share;
}

}  // namespace emberfold::test
