// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dytex/estimation/em_appearance.hpp"
#include "dytex/estimation/em_dynamics.hpp"

namespace emberfold::dytex::detail {

GramModel maximise_gram(const Eigen::MatrixXd& gram, Eigen::Index m, const std::vector<Eigen::Index>& seen,
                        const Smoothed& smoothed, double least_noise) {
  const Eigen::MatrixXd states = smoothed.states(Eigen::all, seen);
  Eigen::MatrixXd S = states * states.transpose();
  for (const Eigen::Index t : seen) S += smoothed.at(t).covariance;
  GramModel model;
  model.W = divide_right(states.transpose(), S);
  const Eigen::MatrixXd GX = gram * states.transpose();
  const double left = gram.trace() - GX.cwiseProduct(model.W).sum();
  model.r = std::max(left / (static_cast<double>(m) * static_cast<double>(seen.size())), least_noise);
  return model;
}

Observations gram_observations(const Eigen::MatrixXd& products, const Eigen::MatrixXd& projections,
                               const Eigen::VectorXd& squares, Eigen::Index m, double r,
                               const std::vector<Eigen::Index>& seen, Eigen::Index frames) {
  Observations result;
  result.vectors = Eigen::MatrixXd::Zero(products.rows(), frames);
  result.squares = result.constants = Eigen::VectorXd::Zero(frames);
  result.information = {products / r};
  result.which.assign(static_cast<std::size_t>(frames), -1);
  const double constant = static_cast<double>(m) * std::log(2 * std::numbers::pi * r);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(i), t = seen[i];
    result.vectors.col(t) = projections.col(from) / r;
    result.squares[t] = squares[from] / r;
    result.constants[t] = constant;
    result.which[static_cast<std::size_t>(t)] = 0;
  }
  return result;
}

namespace {

class GramAppearance final : public Appearance {
 public:
  explicit GramAppearance(const AppearanceInput& input)
      : input_(input), m_(static_cast<Eigen::Index>(input.frame_blocks.values())) {
    for (std::size_t t = 0; t < input.frame_blocks.frames(); ++t)
      if (!input.missing.all_hidden(t)) seen_.push_back(static_cast<Eigen::Index>(t));
    model_.r = std::max(input.start.r, input.options.least_noise);
  }

  Observations observe() override {
    read();
    return observations();
  }

  Observations maximise(const Smoothed& smoothed) override {
    model_ = maximise_gram(gram_, m_, seen_, smoothed, input_.options.least_noise);
    projections_ = model_.W.transpose() * gram_;
    products_ = projections_ * model_.W;
    products_ = ((products_ + products_.transpose()) / 2).eval();
    return observations();
  }

  [[nodiscard]] Eigen::MatrixXd products() const override { return products_; }

  void write(const Eigen::MatrixXd& right, LinearDynamicTexture& texture) override {
    const Eigen::MatrixXd weights = model_.W * right;
    texture.mean.resize(m_);
    texture.C.resize(m_, weights.cols());
    texture.r = model_.r;
    const auto make = [&](std::size_t first, const FrameValues& values) {
      for_sum_blocks(static_cast<Eigen::Index>(values.count), input_.context,
                     [&](std::size_t, Eigen::Index row, Eigen::Index rows) {
                       const Centred block = centred_block(values, first, row, rows);
                       const auto at = static_cast<Eigen::Index>(first) + row;
                       texture.mean.segment(at, rows) = block.mean.cast<float>();
                       texture.C.middleRows(at, rows) = (block.Y * weights).cast<float>();
                     });
    };
    input_.frame_blocks.for_each("making components", true, make, input_.context);
  }

  [[nodiscard]] double r() const override { return model_.r; }

  [[nodiscard]] double r_correction() const override {
    const auto seen = static_cast<double>(seen_.size()),
               left = seen - 1 - static_cast<double>(products_.rows());
    return left > 0 ? seen / left : 1;
  }

 private:
  struct Centred {
    Eigen::MatrixXd Y;  // rows × frames that are seen
    Eigen::VectorXd mean;
  };

  [[nodiscard]] Eigen::Index frames() const {
    return static_cast<Eigen::Index>(input_.frame_blocks.frames());
  }

  [[nodiscard]] Observations observations() const {
    return gram_observations(products_, projections_, gram_.diagonal(), m_, model_.r, seen_, frames());
  }

  [[nodiscard]] Centred centred_block(const FrameValues& values, std::size_t first, Eigen::Index row,
                                      Eigen::Index rows) const {
    const Eigen::MatrixXd all = level_block(values, first, static_cast<std::size_t>(row), rows, 0,
                                            input_.scale, input_.missing, Eigen::VectorXd::Zero(rows));
    Centred block;
    block.Y = all(Eigen::all, seen_);
    block.mean = block.Y.rowwise().mean();
    block.Y.colwise() -= block.mean;
    return block;
  }

  // Reads G of the seen frames, and their observations under the start's C.
  void read() {
    const Eigen::MatrixXf& C = input_.start.C;
    const auto count = static_cast<Eigen::Index>(seen_.size());
    Eigen::MatrixXd raw = Eigen::MatrixXd::Zero(frames(), frames());
    std::vector<Eigen::MatrixXd> projections(kSumSlabs, Eigen::MatrixXd::Zero(C.cols(), count));
    std::vector<Eigen::MatrixXd> products(kSumSlabs, Eigen::MatrixXd::Zero(C.cols(), C.cols()));
    const auto add = [&](std::size_t first, const FrameValues& values) {
      add_gram(values, raw, input_.context);
      for_sum_blocks(static_cast<Eigen::Index>(values.count), input_.context,
                     [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
                       const auto at = static_cast<Eigen::Index>(first) + row;
                       const Eigen::MatrixXd block = C.middleRows(at, rows).cast<double>();
                       projections[slab] += block.transpose() * centred_block(values, first, row, rows).Y;
                       products[slab] += block.transpose() * block;
                     });
    };
    input_.frame_blocks.for_each("comparing frames", false, add, input_.context);
    for (std::size_t s = 1; s < kSumSlabs; ++s) {
      projections[0] += projections[s];
      products[0] += products[s];
    }
    projections_ = projections[0];
    products_ = products[0];
    Eigen::MatrixXd part(count, count);
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index i = j; i < count; ++i)
        part(i, j) = raw(seen_[static_cast<std::size_t>(i)], seen_[static_cast<std::size_t>(j)]);
    gram_ = centred(part) * (input_.scale.to_levels * input_.scale.to_levels);
  }

  AppearanceInput input_;
  Eigen::Index m_;
  std::vector<Eigen::Index> seen_;
  GramModel model_;
  Eigen::MatrixXd gram_, projections_, products_;
};

}  // namespace

std::unique_ptr<Appearance> gram_appearance(const AppearanceInput& input) {
  return std::make_unique<GramAppearance>(input);
}

}  // namespace emberfold::dytex::detail
