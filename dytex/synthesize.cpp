// SPDX-License-Identifier: Apache-2.0
#include "dytex/synthesize.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/synthesis/draw_frames.hpp"
#include "dytex/synthesis/loop.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kBatch = detail::kBatch;  // frames that one pass over C draws
constexpr int kLongestLoop = 1'000'000;         // frames
constexpr std::size_t kValues = 1024;           // of a block
constexpr std::size_t kParts = 16;  // partial sums; fixed, so that results do not depend on threads
constexpr std::uint32_t kFirst = 1, kDriving = 2, kPixels = 3;  // purposes of streams

Eigen::VectorXd normals(core::Rng rng, Eigen::Index count) {
  Eigen::VectorXd result(count);
  for (double& x : result) x = rng.normal();
  return result;
}

core::Stream stream(std::uint64_t frame, std::uint32_t block, std::uint32_t purpose) {
  return {static_cast<std::uint32_t>(frame), block, purpose + (static_cast<std::uint32_t>(frame >> 32) << 2)};
}

std::size_t block_count(const LinearDynamicTexture& texture) {
  return (static_cast<std::size_t>(texture.pixels()) + kValues - 1) / kValues;
}

Eigen::Index first_row(std::size_t block) {
  return static_cast<Eigen::Index>(block * kValues);
}

Eigen::Index row_count(const LinearDynamicTexture& texture, std::size_t block) {
  return std::min(static_cast<Eigen::Index>(kValues), texture.pixels() - first_row(block));
}

/// x(0) ~ N(0, P).
Eigen::VectorXd stationary_state(const LinearDynamicTexture& texture, std::uint64_t seed) {
  if (texture.order() == 0) return {};
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(stationary_covariance(texture.A, texture.B));
  const Eigen::VectorXd scale = eigen.values.cwiseMax(0).cwiseSqrt();
  return eigen.vectors * scale.cwiseProduct(normals(core::Rng(seed, stream(0, 0, kFirst)), texture.order()));
}

/// The weights of C's columns for a state.
Eigen::VectorXf column_weights(const LinearDynamicTexture& texture,
                               const Eigen::Ref<const Eigen::VectorXd>& state) {
  return texture.weights.cwiseProduct(state.head(texture.components())).cast<float>();
}

/// A row vector of the frame's values.
cv::Mat flat_levels(const LinearDynamicTexture& texture, const cv::Mat& levels) {
  const core::ClipInfo& info = texture.info;
  if (levels.cols != info.width || levels.rows != info.height ||
      levels.type() != CV_MAKETYPE(CV_32F, info.channels))
    throw core::InputError("levels are " + std::to_string(levels.cols) + " × " + std::to_string(levels.rows) +
                           " of OpenCV's type " + std::to_string(levels.type()) + ", the texture needs " +
                           std::to_string(info.width) + " × " + std::to_string(info.height) + " of type " +
                           std::to_string(CV_MAKETYPE(CV_32F, info.channels)));
  return levels.isContinuous() ? levels : levels.clone();
}

/// v(t) that leads to this frame.
Eigen::VectorXd driving_noise(const LinearDynamicTexture& texture, std::uint64_t seed, std::uint64_t frame) {
  return normals(core::Rng(seed, stream(frame, 0, kDriving)), texture.B.cols());
}

/// v of all frames of a loop, a column each: v(t) leads to frame t + 1.
Eigen::MatrixXd driving_circle(const LinearDynamicTexture& texture, const SynthesisOptions& options) {
  Eigen::MatrixXd noise(texture.B.cols(), options.loop);
  for (Eigen::Index t = 0; t < noise.cols(); ++t)
    noise.col(t) = driving_noise(texture, options.seed, static_cast<std::uint64_t>(t) + 1);
  return noise;
}

/// w(t) of some values.
class PixelNoise {
 public:
  PixelNoise(const LinearDynamicTexture& texture, Eigen::Index row, Eigen::Index rows)
      : deviations_(texture.noise.size() > 0
                        ? texture.noise.segment(row, rows).cast<double>().array().sqrt().eval()
                        : Eigen::ArrayXd::Constant(rows, std::sqrt(texture.r))) {}
  void add(core::Rng rng, float* levels) const {
    for (Eigen::Index p = 0; p < deviations_.size(); ++p)
      levels[p] += static_cast<float>(deviations_[p] * rng.normal());
  }

 private:
  Eigen::ArrayXd deviations_;
};

}  // namespace

void SynthesisOptions::validate() const {
  if (loop < 0 || loop > kLongestLoop)
    throw core::InputError("SynthesisOptions.loop is " + std::to_string(loop) + "; allowed is 0 to " +
                           std::to_string(kLongestLoop));
  if (from_mean && first_frame)
    throw core::InputError("SynthesisOptions.from_mean is set beside first_frame; allowed is one of them");
  if (loop > 0 && (from_mean || first_frame))
    throw core::InputError("SynthesisOptions.loop is " + std::to_string(loop) +
                           ", and a loop has no first state; allowed is 0 beside first_frame or from_mean");
}

Synthesis::Synthesis(const LinearDynamicTexture& texture, const SynthesisOptions& options)
    : texture_(texture), options_(options) {
  options.validate();
  validate(texture);
  if (options.loop > 0) {
    circle_ = detail::loop_states(texture.A, texture.B, driving_circle(texture, options));
    state_ = circle_.col(0);
  } else if (options.from_mean) {
    state_ = Eigen::VectorXd::Zero(texture.order());
  } else if (!options.first_frame) {
    state_ = stationary_state(texture, options.seed);
  } else {
    const Eigen::Index frames = texture.states.cols(), first = *options.first_frame;
    if (first < 0 || first >= frames)
      throw core::InputError("first_frame is " + std::to_string(first) + "; allowed is 0 to " +
                             std::to_string(frames - 1));
    state_ = texture.states.col(first);
  }
  shown_ = state_;
}

void Synthesis::step() {
  ++frame_;
  if (options_.loop > 0) {
    frame_ %= static_cast<std::uint64_t>(options_.loop);
    state_ = circle_.col(static_cast<Eigen::Index>(frame_));
  } else {
    state_ = texture_.A * state_ + texture_.B * driving_noise(texture_, options_.seed, frame_);
  }
}

cv::Mat Synthesis::next() {
  if (position_ == ready_.size()) render();
  shown_ = states_[position_];
  return std::move(ready_[position_++]);
}

void Synthesis::render() {
  const core::ClipInfo& info = texture_.info;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> states(
      texture_.components(), static_cast<Eigen::Index>(kBatch));
  std::array<std::uint8_t*, kBatch> bytes{};
  std::array<std::uint64_t, kBatch> times{};
  states_.clear();
  ready_.clear();
  position_ = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    if (states.rows() > 0) states.col(static_cast<Eigen::Index>(i)) = column_weights(texture_, state_);
    states_.push_back(state_);
    ready_.emplace_back(info.height, info.width, CV_MAKETYPE(CV_8U, info.channels));
    bytes[i] = ready_.back().data;
    times[i] = frame_;
    step();
  }
  const detail::Batch batch{texture_.mean.data(), texture_.C.data(), texture_.pixels(), texture_.components(),
                            states.data()};
  const detail::Isa isa = detail::best_isa();
  core::parallel_for(block_count(texture_), {}, [&](std::size_t block) {
    const Eigen::Index row = first_row(block), rows = row_count(texture_, block);
    if (!options_.pixel_noise) return detail::draw_bytes(batch, row, rows, bytes, isa);
    Eigen::MatrixXf levels(rows, static_cast<Eigen::Index>(kBatch));
    std::array<float*, kBatch> columns{};
    for (std::size_t i = 0; i < kBatch; ++i) columns[i] = levels.col(static_cast<Eigen::Index>(i)).data();
    detail::draw_levels(batch, row, rows, columns, isa);
    const PixelNoise noise(texture_, row, rows);
    for (std::size_t i = 0; i < kBatch; ++i) {
      noise.add(core::Rng(options_.seed, stream(times[i], static_cast<std::uint32_t>(block), kPixels)),
                columns[i]);
      std::transform(columns[i], columns[i] + rows, bytes[i] + row, detail::byte_of);
    }
  });
}

Eigen::VectorXd project(const LinearDynamicTexture& texture, const cv::Mat& levels) {
  const cv::Mat flat = flat_levels(texture, levels);
  const std::size_t blocks = block_count(texture);
  std::vector<Eigen::VectorXd> parts(kParts, Eigen::VectorXd::Zero(texture.components()));
  core::parallel_for(kParts, {}, [&](std::size_t part) {
    for (std::size_t b = blocks * part / kParts; b < blocks * (part + 1) / kParts; ++b) {
      const Eigen::Index row = first_row(b), rows = row_count(texture, b);
      const Eigen::VectorXf deviation =
          Eigen::Map<const Eigen::VectorXf>(flat.ptr<float>() + row, rows) - texture.mean.segment(row, rows);
      parts[part] += (texture.C.middleRows(row, rows).transpose() * deviation).cast<double>();
    }
  });
  for (std::size_t part = 1; part < kParts; ++part) parts[0] += parts[part];
  return parts[0];
}

cv::Mat draw(const LinearDynamicTexture& texture, const Eigen::Ref<const Eigen::VectorXd>& state) {
  if (state.size() != texture.order() && state.size() != texture.components())
    throw core::InputError("the state has " + std::to_string(state.size()) + " numbers, the texture needs " +
                           std::to_string(texture.order()));
  const core::ClipInfo& info = texture.info;
  cv::Mat levels(info.height, info.width, CV_MAKETYPE(CV_32F, info.channels));
  const Eigen::VectorXf x = column_weights(texture, state);
  core::parallel_for(block_count(texture), {}, [&](std::size_t block) {
    const Eigen::Index row = first_row(block), rows = row_count(texture, block);
    Eigen::Map<Eigen::VectorXf> to(levels.ptr<float>() + row, rows);
    to = texture.mean.segment(row, rows);
    to.noalias() += texture.C.middleRows(row, rows) * x;
  });
  return levels;
}

cv::Mat predict(const LinearDynamicTexture& texture, const cv::Mat& levels) {
  return draw(texture, texture.A * expected_state(texture, project(texture, levels)));
}

}  // namespace emberfold::dytex
