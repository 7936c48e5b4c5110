// SPDX-License-Identifier: Apache-2.0
#include "core/math/lbfgs.hpp"

#include <cmath>
#include <deque>

namespace emberfold::core::detail {

namespace {

constexpr std::size_t kMemory = 10;  // steps from which the inverse Hessian is estimated
constexpr int kWindow = 10;          // steps after which the gain is tested
constexpr int kHalvings = 40;        // of the step length before the direction is given up
constexpr double kArmijo = 1e-4;     // least share of the predicted descent (Nocedal & Wright 2006, eq. 3.4)
constexpr double kFlat = 1e-12;      // least cosine between move and change for a step to be remembered

struct Step {
  Eigen::VectorXd move, change;  // of the point, of the gradient
  double product;                // of the two, > 0
};

/// Returns −H slope with H the inverse Hessian estimated from the steps (Nocedal 1980, two-loop recursion).
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
  Eigen::VectorXd point = std::move(start);
  auto [value, slope] = function(point);
  std::deque<Step> steps;
  double before = value;
  for (int step = 1; step <= most_steps && slope.norm() > 0; ++step) {
    context.check();
    Eigen::VectorXd along = direction(slope, steps);
    double rise = along.dot(slope);
    if (!(rise < 0)) {  // no descent: restart
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
