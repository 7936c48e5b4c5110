// SPDX-License-Identifier: Apache-2.0
#include "mcmc/predict.hpp"

#include <Eigen/Core>

#include "mcmc/lineages.hpp"

namespace emberfold::mcmc {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double anywhere = 100;      // px: SD of rest about where a path begins
constexpr double least_error = 0.02;  // px: SD of a measured place

// (d(t), d(t−1), rest) of a path whose every place is d + rest, measured with an error.
class RestFilter {
 public:
  explicit RestFilter(const Autoregression& m)
      : error_(m.measurement * m.measurement + least_error * least_error) {
    step_ << m.a1, m.a2, 0, 1, 0, 0, 0, 0, 1;
    noise_ = m.noise * m.noise;
    // The stationary covariance of an AR(2).
    const double variance = noise_ * (1 - m.a2) / ((1 + m.a2) * ((1 - m.a2) * (1 - m.a2) - m.a1 * m.a1));
    const double next = variance * m.a1 / (1 - m.a2);
    covariance_ << variance, next, 0, next, variance, 0, 0, 0, anywhere * anywhere;
  }
  void measure(double place) {
    const Vector3d with = covariance_.col(0) + covariance_.col(2);
    const double total = with[0] + with[2] + error_;
    const Vector3d gain = with / total;
    state_ += gain * (place - state_[0] - state_[2]);
    covariance_ -= gain * with.transpose();
  }
  void advance() {
    state_ = step_ * state_;
    covariance_ = step_ * covariance_ * step_.transpose();
    covariance_(0, 0) += noise_;
  }
  [[nodiscard]] double place() const { return state_[0] + state_[2]; }

 private:
  Matrix3d step_, covariance_;
  Vector3d state_ = Vector3d::Zero();
  double noise_ = 0, error_ = 0;
};

}  // namespace

std::vector<graph::AttributeGraph> predict(const MotionModel& model, const graph::MotionGraph& motion) {
  validate(model);
  const auto& frames = motion.sketch.frames;
  std::vector<std::vector<detail::Told>> told(frames.size());
  for (const auto& lineage : detail::lineages(motion)) {
    RestFilter filter(model.sway);
    double drifted = 0;
    for (std::size_t k = 0; k < lineage.samples.size(); ++k) {
      const auto& sample = lineage.samples[k];
      if (k > 0) filter.advance();
      filter.measure(sample.travel - drifted);
      RestFilter next = filter;
      next.advance();
      const graph::Point v{model.drift_x.at(sample.position), model.drift_y.at(sample.position)};
      const double drift = graph::dot(v, sample.normal);
      const double expected = next.place() + drifted + drift;
      told[static_cast<std::size_t>(lineage.first) + k].push_back(
          {sample.vertex, sample.normal * (expected - sample.travel)});
      drifted += drift;
    }
  }
  std::vector<graph::AttributeGraph> result(frames.size());
  for (std::size_t t = 1; t < frames.size(); ++t) {
    const auto steps = detail::on_patches(frames[t - 1], told[t - 1]);
    std::vector<graph::Vertex> vertices(frames[t - 1].vertices().begin(), frames[t - 1].vertices().end());
    for (std::size_t v = 0; v < vertices.size(); ++v)
      vertices[v].patch.position = vertices[v].patch.position + steps[v];
    result[t] = {std::move(vertices), {frames[t - 1].edges().begin(), frames[t - 1].edges().end()}};
  }
  return result;
}

}  // namespace emberfold::mcmc
