// SPDX-License-Identifier: Apache-2.0
#include "core/math/lbfgs.hpp"

#include <cmath>
#include <deque>

namespace emberfold::core::detail {

namespace {

struct Step {
  Eigen::VectorXd move, change;  // of the point, of the slope
  double product;                // of the two, > 0
};

/// −H slope, H the inverse curvature that the steps tell (Nocedal 1980, two loops).
Eigen::VectorXd direction(const Eigen::VectorXd& slope, const std::deque<Step>& steps) {
  Eigen::VectorXd along = -slope;
  std::vector<double> parts(steps.size());
  for (std::size_t i = steps.size(); i-- > 0;) {
    parts[i] = steps[i].move.dot(along) / steps[i].product;
    along -= parts[i] * steps[i].change;
  }
  if (!steps.empty()) along *= steps.back().product / steps.back().change.squaredNorm();
  for (std::size_t i = 0; i < steps.size(); ++i)
    along += (parts[i] - steps[i].change.dot(along) / steps[i].product) * steps[i].move;
  return along;
}

}  // namespace

Eigen::VectorXd minimize_lbfgs(const Gradient& function, Eigen::VectorXd start, int most_steps,
                               double least_gain, const core::Context& context) {
  constexpr std::size_t kMemory = 10;
  constexpr int kWindow = 10, kHalvings = 40;
  constexpr double kArmijo = 1e-4, kFlat = 1e-12;
  Eigen::VectorXd point = std::move(start);
  auto [value, slope] = function(point);
  std::deque<Step> steps;
  double before = value;
  for (int step = 1; step <= most_steps && slope.norm() > 0 && !context.cancelled(); ++step) {
    Eigen::VectorXd along = direction(slope, steps);
    double rise = along.dot(slope);
    if (!(rise < 0)) {  // the curvature misleads
      steps.clear();
      along = -slope, rise = -slope.squaredNorm();
    }
    double length = steps.empty() ? std::min(1.0, 1 / slope.norm()) : 1;
    std::pair<double, Eigen::VectorXd> next;
    int halved = 0;
    for (; halved < kHalvings; ++halved, length /= 2) {
      next = function(point + length * along);
      if (std::isfinite(next.first) && next.first <= value + kArmijo * length * rise) break;
    }
    if (halved == kHalvings) {
      if (steps.empty()) break;
      steps.clear();
      continue;
    }
    Step taken{length * along, next.second - slope, 0};
    taken.product = taken.move.dot(taken.change);
    if (taken.product > kFlat * taken.change.norm() * taken.move.norm()) {
      if (steps.size() == kMemory) steps.pop_front();
      steps.push_back(taken);
    }
    point += taken.move;
    value = next.first, slope = std::move(next.second);
    if (step % kWindow != 0) continue;
    if (before - value < least_gain) break;
    before = value;
  }
  return point;
}

}  // namespace emberfold::core::detail
