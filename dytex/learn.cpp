// SPDX-License-Identifier: Apache-2.0
#include "dytex/learn.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include <Eigen/Cholesky>
#include <opencv2/core/hal/interface.h>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/decompose.hpp"
#include "dytex/dynamics.hpp"
#include "dytex/frame_bands.hpp"
#include "dytex/gram.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBands;
using detail::FrameValues;

constexpr std::size_t kMostFrames = 5000;          // beyond, τ × τ eigenvalues take many minutes
constexpr std::size_t kRows = 2 * detail::kBlock;  // values of a block of C
constexpr std::size_t kSlabs = 16;                 // parts in which CᵀC is summed
constexpr double kFloatRange = 1e3;  // of singular values, up to which C is made in single precision

std::string number_text(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

/// C's columns Y V S⁻¹ and the mean, for the values of one block.
template <class Value, class Scalar>
void project_block(const FrameValues& values, std::size_t begin, std::size_t first, double to_levels,
                   const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& weights,
                   LinearDynamicTexture& texture) {
  const auto rows = static_cast<Eigen::Index>(std::min(kRows, values.count - begin));
  const auto frames = static_cast<Eigen::Index>(values.frames.size());
  const auto frame = [&](Eigen::Index t) {
    const auto* from = static_cast<const Value*>(values.frames[static_cast<std::size_t>(t)]) + begin;
    return Eigen::Map<const Eigen::Vector<Value, Eigen::Dynamic>>(from, rows);
  };
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index t = 0; t < frames; ++t) mean += frame(t).template cast<double>();
  mean /= static_cast<double>(frames);
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> centred(rows, frames);
  const Eigen::Vector<Scalar, Eigen::Dynamic> scalar_mean = mean.cast<Scalar>();
  for (Eigen::Index t = 0; t < frames; ++t) centred.col(t) = frame(t).template cast<Scalar>() - scalar_mean;
  const auto row = static_cast<Eigen::Index>(first + begin);
  texture.mean.segment(row, rows) = (mean * to_levels).cast<float>();
  if constexpr (std::is_same_v<Scalar, float>) {
    texture.C.middleRows(row, rows).noalias() = centred * weights;
  } else {
    texture.C.middleRows(row, rows) = (centred * weights).template cast<float>();
  }
}

template <class Scalar>
core::Status project_band(std::size_t first, const FrameValues& values, double to_levels,
                          const Eigen::MatrixXd& weights, LinearDynamicTexture& texture,
                          const core::Context& context) {
  const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> w = weights.cast<Scalar>();
  return core::parallel_for((values.count + kRows - 1) / kRows, context, [&](std::size_t i) {
    if (values.depth == CV_8U)
      return project_block<std::uint8_t, Scalar>(values, i * kRows, first, to_levels, w, texture);
    if (values.depth == CV_16U)
      return project_block<std::uint16_t, Scalar>(values, i * kRows, first, to_levels, w, texture);
    project_block<float, Scalar>(values, i * kRows, first, to_levels, w, texture);
  });
}

/// Calls body(slab, first row, rows) for blocks of C's rows; those of a slab one after another.
core::Status for_row_blocks(Eigen::Index m, const core::Context& context,
                            const std::function<void(std::size_t, Eigen::Index, Eigen::Index)>& body) {
  const Eigen::Index step = kRows, blocks = (m + step - 1) / step;
  const auto slabs = static_cast<Eigen::Index>(kSlabs);
  return core::parallel_for(kSlabs, context, [&](std::size_t slab) {
    const auto s = static_cast<Eigen::Index>(slab);
    for (Eigen::Index b = blocks * s / slabs; b < blocks * (s + 1) / slabs && !context.cancelled(); ++b)
      body(slab, b * step, std::min(step, m - b * step));
  });
}

/// C ← C L⁻ᵀ with CᵀC = L Lᵀ: what rounding took from the columns' right angles and lengths.
core::Status orthonormalise(Eigen::MatrixXf& C, const core::Context& context) {
  const Eigen::Index n = C.cols();
  std::vector<Eigen::MatrixXd> parts(kSlabs, Eigen::MatrixXd::Zero(n, n));
  for_row_blocks(C.rows(), context, [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
    const auto block = C.middleRows(row, rows);
    parts[slab] += Eigen::MatrixXf(block.transpose() * block).cast<double>();
  });
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& part : parts) products += part;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(products);
  if (context.cancelled()) return core::Status::cancelled;
  if (cholesky.info() != Eigen::Success)
    throw core::NumericalError("learn: the components are not independent");
  const Eigen::MatrixXd right = cholesky.matrixL().solve(Eigen::MatrixXd::Identity(n, n)).transpose();
  const Eigen::MatrixXf correction = right.cast<float>();
  return for_row_blocks(C.rows(), context, [&](std::size_t, Eigen::Index row, Eigen::Index rows) {
    C.middleRows(row, rows) = (C.middleRows(row, rows) * correction).eval();
  });
}

struct Spectrum {
  Eigen::VectorXd singular;  // τ, falling, in levels
  Eigen::MatrixXd V;         // τ × rank
  Eigen::Index rank() const { return V.cols(); }
};

/// Singular values and right singular vectors of the centred frames from their raw Gram matrix.
Spectrum spectrum(const Eigen::MatrixXd& gram, double to_levels, Eigen::Index m) {
  const Eigen::Index frames = gram.rows();
  if (!gram.triangularView<Eigen::Lower>().toDenseMatrix().allFinite())
    throw core::InputError("the clip has a value that is not finite");
  detail::SymmetricEigen eigen = detail::symmetric_eigen(detail::centred(gram));
  // What rounding makes of an eigenvalue of 0: the entries' errors, times τ.
  const double least = 8 * static_cast<double>(frames) * std::numeric_limits<double>::epsilon() *
                       gram.diagonal().cwiseAbs().maxCoeff();
  const Eigen::Index rank = std::min({(eigen.values.array() > least).count(), frames - 1, m});
  eigen.values.tail(frames - rank).setZero();
  return {to_levels * eigen.values.cwiseSqrt(), eigen.vectors.leftCols(rank)};
}

/// How many components to take, with a note where they are fewer than asked for.
Eigen::Index choose_order(const Spectrum& spectrum, const LearnOptions& options, LearnResult& result) {
  const Eigen::VectorXd variance = spectrum.singular.cwiseAbs2();
  if (spectrum.rank() == 0) {
    result.notes.emplace_back("the frames do not change: the model is their mean, without components");
    return 0;
  }
  if (options.energy) {
    const double wanted = *options.energy * variance.sum();
    double sum = 0;
    Eigen::Index n = 0;
    while (n < spectrum.rank() && sum < wanted) sum += variance[n++];
    return n;
  }
  const Eigen::Index asked = options.components;
  if (spectrum.rank() >= asked) return asked;
  result.notes.push_back("the frames change in " + std::to_string(spectrum.rank()) +
                         (spectrum.rank() == 1 ? " direction only, " : " directions only, ") +
                         std::to_string(asked) + " components were asked for: the model has " +
                         std::to_string(spectrum.rank()));
  return spectrum.rank();
}

void take_dynamics(detail::Dynamics dynamics, LearnResult& result) {
  result.least_squares_radius = dynamics.least_squares_radius;
  if (dynamics.yule_walker) {
    result.transition = Transition::yule_walker;
    result.notes.push_back((dynamics.noiseless
                                ? std::string("the least-squares fit leaves no noise to go on from")
                                : "the least-squares fit is not stable (spectral radius " +
                                      number_text(dynamics.least_squares_radius) + ")") +
                           ": the Yule-Walker fit is taken");
  }
  result.texture.A = std::move(dynamics.A);
  result.texture.B = std::move(dynamics.B);
}

/// Says where clips drawn from the model vary much more or less than the clip itself.
void compare_variance(LearnResult& result) {
  constexpr double kMuch = 1.5;
  const LinearDynamicTexture& texture = result.texture;
  if (texture.order() == 0) return;
  const double drawn = stationary_covariance(texture.A, texture.B).trace();
  const double seen = texture.states.squaredNorm() / static_cast<double>(texture.states.cols());
  if (drawn <= kMuch * seen && seen <= kMuch * drawn) return;
  std::ostringstream share;
  share << std::setprecision(2) << drawn / seen;
  result.notes.push_back("clips drawn from the model have " + share.str() +
                         " times the variance of the clip it was learned from");
}

/// The variance that n components leave, by its degrees of freedom: n directions of the frames and of time,
/// and the mean, are taken out of m × τ values.
double left_variance(const Eigen::VectorXd& singular, Eigen::Index n, Eigen::Index m) {
  const Eigen::Index frames = singular.size(), gaps = frames - 1 - n;
  if (gaps <= 0 || m <= n) return 0;
  return singular.tail(frames - n).squaredNorm() / (static_cast<double>(m - n) * static_cast<double>(gaps));
}

LearnResult cancelled(const FrameBands& bands) {
  LearnResult result;
  result.status = core::Status::cancelled;
  result.passes = bands.passes();
  return result;
}

}  // namespace

void LearnOptions::validate() const {
  if (components < 1)
    throw core::InputError("components is " + std::to_string(components) + ", must be at least 1");
  if (energy && !(*energy > 0 && *energy <= 1))
    throw core::InputError("energy is " + number_text(*energy) + ", allowed is above 0 to 1");
  if (memory < std::size_t{1} << 20)
    throw core::InputError("memory is " + std::to_string(memory) + " bytes, must be at least 1048576");
}

LearnResult learn(core::FrameSource& source, const LearnOptions& options, const core::Context& context) {
  options.validate();
  FrameBands bands(source, options.memory, kMostFrames, context);
  if (bands.frames() == 0) return cancelled(bands);
  const auto frames = static_cast<Eigen::Index>(bands.frames()),
             m = static_cast<Eigen::Index>(bands.values());
  if (!options.energy && options.components > frames - 1)
    throw core::InputError("n is " + std::to_string(options.components) + "; a clip of " +
                           std::to_string(frames) + " frames has at most " + std::to_string(frames - 1) +
                           (frames == 2 ? " component" : " components"));

  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(frames, frames);
  const auto add = [&](std::size_t, const FrameValues& values) { return add_gram(values, gram, context); };
  if (bands.for_each("comparing frames", false, add, context) == core::Status::cancelled)
    return cancelled(bands);
  const double to_levels = 255 / source.info().white;
  Spectrum found = spectrum(gram, to_levels, m);
  gram.resize(0, 0);

  LearnResult result;
  LinearDynamicTexture& texture = result.texture;
  const Eigen::Index n = choose_order(found, options, result);
  const Eigen::VectorXd s = found.singular.head(n);
  const Eigen::MatrixXd V = found.V.leftCols(n);
  texture.mean.resize(m);
  texture.C.resize(m, n);
  const Eigen::MatrixXd weights = V * s.cwiseInverse().asDiagonal() * to_levels;
  const bool single = n == 0 || s[0] <= kFloatRange * s[n - 1];
  const auto project = [&](std::size_t first, const FrameValues& values) {
    return single ? project_band<float>(first, values, to_levels, weights, texture, context)
                  : project_band<double>(first, values, to_levels, weights, texture, context);
  };
  if (bands.for_each("making components", true, project, context) == core::Status::cancelled ||
      orthonormalise(texture.C, context) == core::Status::cancelled)
    return cancelled(bands);

  take_dynamics(detail::fit_dynamics(s, V), result);
  texture.info = source.info();
  texture.info.frames = frames;
  texture.r = left_variance(found.singular, n, m);
  texture.states = s.asDiagonal() * V.transpose();
  texture.weights = Eigen::VectorXd::Ones(n);
  texture.singular = std::move(found.singular);
  compare_variance(result);
  result.passes = bands.passes();
  return result;
}

}  // namespace emberfold::dytex
