// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/parallel.hpp"
#include "dytex/estimation/em_appearance.hpp"
#include "dytex/estimation/em_dynamics.hpp"

namespace emberfold::dytex::detail {

namespace {

/// E z(t) z(t)ᵀ of every frame, z the state, followed by 1 where a mean is fitted too. The lower halves,
/// packed by column.
struct FrameMoments {
  Eigen::MatrixXd z;       // size × τ
  Eigen::MatrixXd packed;  // size (size + 1) / 2 × τ
  Eigen::VectorXd total;   // over frames of which any value is seen

  [[nodiscard]] Eigen::Index size() const { return z.rows(); }
};

FrameMoments frame_moments(const Smoothed& smoothed, bool with_mean, const Missing& missing) {
  const Eigen::Index n = smoothed.states.rows(), frames = smoothed.states.cols(),
                     size = n + (with_mean ? 1 : 0);
  FrameMoments result;
  result.z = Eigen::MatrixXd::Ones(size, frames);
  result.z.topRows(n) = smoothed.states;
  result.packed.resize(size * (size + 1) / 2, frames);
  result.total = Eigen::VectorXd::Zero(result.packed.rows());
  for (Eigen::Index t = 0; t < frames; ++t) {
    Eigen::MatrixXd moment = result.z.col(t) * result.z.col(t).transpose();
    moment.topLeftCorner(n, n) += smoothed.at(t).covariance;
    for (Eigen::Index j = 0, at = 0; j < size; at += size - j, ++j)
      result.packed.col(t).segment(at, size - j) = moment.col(j).tail(size - j);
    if (!missing.all_hidden(static_cast<std::size_t>(t))) result.total += result.packed.col(t);
  }
  return result;
}

Eigen::MatrixXd unpack(const Eigen::VectorXd& packed, Eigen::Index size) {
  Eigen::MatrixXd full(size, size);
  for (Eigen::Index j = 0, at = 0; j < size; at += size - j, ++j)
    full.col(j).tail(size - j) = packed.segment(at, size - j);
  return full.selfadjointView<Eigen::Lower>();
}

/// Counts the frames in which a pixel is seen.
std::size_t seen_count(const Missing& missing, std::size_t pixel, std::size_t frames) {
  if (!missing.any()) return frames;
  std::size_t hidden = 0;
  for (const std::uint64_t word : missing.pattern(pixel))
    hidden += static_cast<std::size_t>(std::popcount(word));
  return frames - hidden;
}

/// Sums E z zᵀ over the frames in which a pixel is seen.
Eigen::MatrixXd moment_of(const FrameMoments& moments, const Missing& missing, std::size_t pixel,
                          std::size_t seen) {
  const auto frames = static_cast<std::size_t>(moments.z.cols());
  if (seen == frames) return unpack(moments.total, moments.size());
  const bool take_off = 2 * seen >= frames;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(moments.packed.rows());
  for (std::size_t t = 0; t < frames; ++t)
    if (missing.hidden(pixel, t) == take_off && !(take_off && missing.all_hidden(t)))
      sum += moments.packed.col(static_cast<Eigen::Index>(t));
  if (take_off) sum = moments.total - sum;
  return unpack(sum, moments.size());
}

class ValueAppearance final : public Appearance {
 public:
  explicit ValueAppearance(const AppearanceInput& input)
      : input_(input),
        m_(static_cast<Eigen::Index>(input.frame_blocks.values())),
        C_(input.start.C.cast<double>()),
        base_(input.start.mean.cast<double>()),
        shift_(Eigen::VectorXd::Zero(m_)),
        with_mean_(input.missing.any() && !input.missing.by_frames()) {
    const double r = std::max(input.start.r, input.options.least_noise);
    noise_ = Eigen::VectorXd::Constant(m_, r);
    if (input.options.noise_per_value && input.start.noise.size() == m_)
      noise_ = input.start.noise.cast<double>().cwiseMax(input.options.least_noise);
    count_seen();
  }

  Observations observe() override { return sweep(nullptr); }

  Observations maximise(const Smoothed& smoothed) override {
    const FrameMoments moments = frame_moments(smoothed, with_mean_, input_.missing);
    return sweep(&moments);
  }

  [[nodiscard]] Eigen::MatrixXd products() const override {
    std::vector<Eigen::MatrixXd> parts(kSumSlabs, Eigen::MatrixXd::Zero(C_.cols(), C_.cols()));
    for_sum_blocks(m_, {}, [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
      parts[slab] += C_.middleRows(row, rows).transpose() * C_.middleRows(row, rows);
    });
    for (std::size_t s = 1; s < kSumSlabs; ++s) parts[0] += parts[s];
    return parts[0];
  }

  void write(const Eigen::MatrixXd& right, LinearDynamicTexture& texture) override {
    texture.mean = (base_ + shift_).cast<float>();
    texture.C.resize(m_, right.cols());
    for_sum_blocks(m_, input_.context, [&](std::size_t, Eigen::Index row, Eigen::Index rows) {
      texture.C.middleRows(row, rows) = (C_.middleRows(row, rows) * right).cast<float>();
    });
    texture.r = r();
    texture.noise.resize(0);
    if (input_.options.noise_per_value) texture.noise = noise_.cast<float>();
  }

  [[nodiscard]] double r() const override { return noise_.mean(); }

  [[nodiscard]] double r_correction() const override {
    const double fitted = static_cast<double>(C_.cols() + 1) * static_cast<double>(fitted_values_);
    const auto seen = static_cast<double>(seen_values_);
    return seen > fitted ? seen / (seen - fitted) : 1;
  }

  [[nodiscard]] std::vector<std::string> notes() const override {
    const auto kept = static_cast<std::size_t>(m_) - fitted_values_;
    if (kept == 0) return {};
    return {std::to_string(kept) + " of " + std::to_string(m_) + " values are seen in fewer than " +
            std::to_string(C_.cols() + 2) + " frames: they keep the components that they began with"};
  }

 private:
  /// Sums over one block, per slab.
  struct Sums {
    Eigen::MatrixXd vectors;  // n × τ
    Eigen::VectorXd squares;  // τ
    double left = 0;          // Σ of squared residuals of the values that are seen
  };

  [[nodiscard]] Eigen::Index frames() const {
    return static_cast<Eigen::Index>(input_.frame_blocks.frames());
  }
  [[nodiscard]] std::size_t pixel(Eigen::Index value) const {
    return static_cast<std::size_t>(value) / input_.scale.channels;
  }
  [[nodiscard]] std::size_t count_seen(Eigen::Index value) const {
    return seen_count(input_.missing, pixel(value), input_.frame_blocks.frames());
  }
  [[nodiscard]] bool fitted(std::size_t seen) const {
    return seen >= static_cast<std::size_t>(C_.cols()) + 2;
  }

  void count_seen() {
    const std::size_t channels = input_.scale.channels;
    for (std::size_t p = 0; p < static_cast<std::size_t>(m_) / channels; ++p) {
      const std::size_t count = seen_count(input_.missing, p, input_.frame_blocks.frames());
      seen_values_ += channels * count;
      if (fitted(count)) fitted_values_ += channels;
    }
  }

  // One pass: fits rows if there are moments, then sums up the clip's observations of the states.
  Observations sweep(const FrameMoments* moments) {
    const bool each = input_.options.noise_per_value;
    const Sums none{Eigen::MatrixXd::Zero(C_.cols(), frames()), Eigen::VectorXd::Zero(frames())};
    std::vector<Sums> slabs(kSumSlabs, none);
    const auto add = [&](std::size_t first, const FrameValues& values) {
      for_sum_blocks(static_cast<Eigen::Index>(values.count), input_.context,
                     [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
                       const auto at = static_cast<Eigen::Index>(first) + row;
                       Eigen::MatrixXd Y = level_block(values, first, static_cast<std::size_t>(row), rows, 0,
                                                       input_.scale, input_.missing, base_.segment(at, rows));
                       if (moments != nullptr) slabs[slab].left += fit_rows(*moments, Y, at);
                       add_rows(Y, at, each, slabs[slab]);
                     });
    };
    const bool back = backwards_;
    backwards_ = !backwards_;  // begins with the block that is still in memory
    input_.frame_blocks.for_each("reading values", back, add, context_);
    for (std::size_t s = 1; s < kSumSlabs; ++s) {
      slabs[0].vectors += slabs[s].vectors;
      slabs[0].squares += slabs[s].squares;
      slabs[0].left += slabs[s].left;
    }
    if (moments != nullptr && !each)
      noise_.setConstant(
          std::max(slabs[0].left / static_cast<double>(seen_values_), input_.options.least_noise));
    const double inverse = each ? 1 : 1 / noise_[0];
    Observations result;
    result.vectors = slabs[0].vectors * inverse;
    result.squares = slabs[0].squares * inverse;
    const auto rows_of = [&](Eigen::Index row, Eigen::Index rows) {
      return WeightedRows{C_.middleRows(row, rows), noise_.segment(row, rows).cwiseInverse()};
    };
    add_information(m_, C_.cols(), input_.frame_blocks.frames(), input_.scale, input_.missing, rows_of,
                    result, input_.context);
    return result;
  }

  // Fits C, mean and noise of a block's rows, those of one pattern at a time; returns their summed residual.
  double fit_rows(const FrameMoments& moments, const Eigen::MatrixXd& Y, Eigen::Index at) {
    const Eigen::Index rows = Y.rows();
    const Eigen::MatrixXd products = Y * moments.z.transpose();
    const Eigen::VectorXd squares = Y.rowwise().squaredNorm();
    double left = 0;
    for (Eigen::Index begin = 0, end = 0; begin < rows; begin = end) {
      for (end = begin + 1; end < rows && same_pattern(at + begin, at + end);) ++end;
      const std::size_t count = count_seen(at + begin);
      if (count == 0) continue;
      const Eigen::MatrixXd S = moment_of(moments, input_.missing, pixel(at + begin), count);
      const Eigen::Index size = end - begin;
      const Eigen::MatrixXd targets = products.middleRows(begin, size);
      Eigen::MatrixXd weights(size, moments.size());
      if (fitted(count)) {
        weights = divide_right(targets, S);
        C_.middleRows(at + begin, size) = weights.leftCols(C_.cols());
        if (with_mean_) shift_.segment(at + begin, size) = weights.col(C_.cols());
      } else {
        weights.leftCols(C_.cols()) = C_.middleRows(at + begin, size);
        if (with_mean_) weights.col(C_.cols()) = shift_.segment(at + begin, size);
      }
      const Eigen::VectorXd rest = squares.segment(begin, size) -
                                   2 * weights.cwiseProduct(targets).rowwise().sum() +
                                   (weights * S).cwiseProduct(weights).rowwise().sum();
      if (input_.options.noise_per_value)
        noise_.segment(at + begin, size) =
            (rest / static_cast<double>(count)).cwiseMax(input_.options.least_noise);
      left += rest.sum();
    }
    return left;
  }

  [[nodiscard]] bool same_pattern(Eigen::Index a, Eigen::Index b) const {
    if (!input_.missing.any() || pixel(a) == pixel(b)) return true;
    const auto p = input_.missing.pattern(pixel(a)), q = input_.missing.pattern(pixel(b));
    return std::equal(p.begin(), p.end(), q.begin());
  }

  void add_rows(Eigen::MatrixXd& Y, Eigen::Index at, bool each, Sums& sums) const {
    const Eigen::Index rows = Y.rows();
    if (with_mean_)
      for (Eigen::Index t = 0; t < Y.cols(); ++t)
        for (Eigen::Index i = 0; i < rows; ++i)
          if (!input_.missing.hidden(pixel(at + i), static_cast<std::size_t>(t))) Y(i, t) -= shift_[at + i];
    if (each) Y.array().colwise() *= noise_.segment(at, rows).array().rsqrt();
    sums.squares += Y.colwise().squaredNorm().transpose();
    if (each) Y.array().colwise() *= noise_.segment(at, rows).array().rsqrt();
    sums.vectors.noalias() += C_.middleRows(at, rows).transpose() * Y;
  }

  AppearanceInput input_;
  core::Context context_ = input_.context.with_progress({});  // passes are parts of an iteration
  Eigen::Index m_;
  Eigen::MatrixXd C_;                     // m × n
  Eigen::VectorXd base_, shift_, noise_;  // m; the mean is base + shift
  bool with_mean_, backwards_ = false;
  std::size_t seen_values_ = 0, fitted_values_ = 0;
};

}  // namespace

std::unique_ptr<Appearance> value_appearance(const AppearanceInput& input) {
  return std::make_unique<ValueAppearance>(input);
}

}  // namespace emberfold::dytex::detail
